// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/interrupts.h"

#include <fcntl.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "palpate/core/output_file.h"

namespace palpate::apps {
namespace {

using std::chrono::milliseconds;

/// A stop that takes less is not announced.
constexpr milliseconds kUnnoticed{100};
constexpr milliseconds kStep{20};

std::atomic<int> throwers = 0, without_haste = 0;
std::atomic<bool> is_interrupted = false;
std::mutex at_interrupt_mutex;
std::function<void()> at_interrupt;  // guarded by the mutex
int signals_to_watcher = -1;         // the end of a pipe; a handler may write to it, but not lock

std::mutex ending_mutex;  // held while the watcher prints or ends the program, see stop_watching
std::mutex words_mutex;
std::string kept = "completed files are kept, no other file was changed";  // guarded by the mutex
std::string how_to_continue;                                               // the same

void tell_watcher(int /*signal*/) {
  const int reason = errno;
  [[maybe_unused]] const ssize_t written = ::write(signals_to_watcher, "", 1);
  errno = reason;
}

void say(const std::string& words) {
  if (::isatty(STDERR_FILENO) != 0) std::fputs("\r\x1b[K", stderr);  // erases a progress bar
  spdlog::critical("{}", words);
}

[[noreturn]] void end_program() {
  const std::lock_guard lock(ending_mutex);
  abandon_temporaries();
  say(interrupt_message());
  ::_exit(kInterruptedStatus);
}

/// Returns true if a signal arrives before `time` has passed; a negative time waits for ever.
bool is_signalled_within(int signals, milliseconds time) {
  pollfd waiting{.fd = signals, .events = POLLIN, .revents = 0};
  if (::poll(&waiting, 1, static_cast<int>(time.count())) != 1) return false;
  char byte = 0;
  return ::read(signals, &byte, 1) == 1;
}

/// Ends the program at the next signal, or if it takes too long to stop by itself.
[[noreturn]] void end_if_it_does_not_stop(int signals) {
  if (is_signalled_within(signals, kUnnoticed)) end_program();
  {
    const std::lock_guard lock(ending_mutex);
    say("stopping; press Ctrl-C again to end at once");
  }
  for (milliseconds waited = kUnnoticed; waited < kLongestStop;) {
    if (is_signalled_within(signals, kStep)) break;
    waited = without_haste > 0 ? milliseconds(0) : waited + kStep;
  }
  end_program();
}

void watch(int signals) {
  while (!is_signalled_within(signals, milliseconds(-1))) continue;
  if (throwers == 0) end_program();
  is_interrupted = true;
  {
    const std::lock_guard lock(at_interrupt_mutex);
    if (at_interrupt) at_interrupt();
  }
  end_if_it_does_not_stop(signals);
}

}  // namespace

void watch_for_interrupts() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    throw std::system_error(errno, std::generic_category(), "a pipe for Ctrl-C");
  signals_to_watcher = ends[1];
  std::thread(watch, ends[0]).detach();
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction action = {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = tell_watcher;
    action.sa_flags = SA_RESTART;
    sigaction(signal, &action, nullptr);
  }
}

void stop_watching() {
  static std::once_flag once;
  std::call_once(once, [] { ending_mutex.lock(); });  // for good
}

std::string interrupt_message() {
  const std::lock_guard lock(words_mutex);
  return "interrupted; " + kept + (how_to_continue.empty() ? "" : "; " + how_to_continue);
}

InterruptMessage::InterruptMessage(std::string now_kept, std::string now_to_continue) {
  const std::lock_guard lock(words_mutex);
  kept_before_ = kept;
  how_to_continue_before_ = how_to_continue;
  if (!now_kept.empty()) kept = std::move(now_kept);
  if (!now_to_continue.empty()) how_to_continue = std::move(now_to_continue);
}
InterruptMessage::~InterruptMessage() {
  const std::lock_guard lock(words_mutex);
  kept = std::move(kept_before_);
  how_to_continue = std::move(how_to_continue_before_);
}
void InterruptMessage::set_kept(std::string now_kept) {
  const std::lock_guard lock(words_mutex);
  kept = std::move(now_kept);
}

InterruptedByThrowing::InterruptedByThrowing() { ++throwers; }
InterruptedByThrowing::~InterruptedByThrowing() { --throwers; }

void InterruptedByThrowing::check() {
  if (is_interrupted) throw Interrupted{};
}

InterruptedWithoutHaste::InterruptedWithoutHaste() { ++without_haste; }
InterruptedWithoutHaste::~InterruptedWithoutHaste() { --without_haste; }

AtInterrupt::AtInterrupt(std::function<void()> call) {
  const std::lock_guard lock(at_interrupt_mutex);
  at_interrupt = std::move(call);
  if (is_interrupted) at_interrupt();
}
AtInterrupt::~AtInterrupt() {
  const std::lock_guard lock(at_interrupt_mutex);
  at_interrupt = nullptr;
}

}  // namespace palpate::apps
