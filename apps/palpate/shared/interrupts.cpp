// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/interrupts.h"

#include <fcntl.h>
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

#include "palpate/output_file.h"

namespace palpate::apps {
namespace {

std::atomic<int> throwers = 0;
std::atomic<bool> is_interrupted = false;
std::mutex at_interrupt_mutex;
std::function<void()> at_interrupt;  // guarded by the mutex
int signals_to_watcher = -1;         // the end of a pipe; a handler may write to it, but not lock

void tell_watcher(int /*signal*/) {
  const int reason = errno;
  [[maybe_unused]] const ssize_t written = ::write(signals_to_watcher, "", 1);
  errno = reason;
}

[[noreturn]] void end_program() {
  abandon_temporaries();
  if (::isatty(STDERR_FILENO) != 0) std::fputs("\r\x1b[K", stderr);  // erases a progress bar
  spdlog::critical("{}", Interrupted{}.message);
  ::_exit(kInterruptedStatus);
}

void watch(int signals) {
  for (char byte = 0; true;) {
    const ssize_t read = ::read(signals, &byte, 1);
    if (read == -1 && errno == EINTR) continue;
    if (read != 1) return;
    if (throwers == 0 || is_interrupted.exchange(true)) end_program();
    const std::lock_guard lock(at_interrupt_mutex);
    if (at_interrupt) at_interrupt();
  }
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

InterruptedByThrowing::InterruptedByThrowing() { ++throwers; }
InterruptedByThrowing::~InterruptedByThrowing() { --throwers; }

void InterruptedByThrowing::check() {
  if (is_interrupted) throw Interrupted{};
}

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
