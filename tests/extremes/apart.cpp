// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "apart.h"

#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <new>
#include <stdexcept>

#include "palpate/core/error.h"

namespace palpate::extremes {
namespace {

/// A process that neither works nor ends is taken for stuck after this many times the processor
/// time that its task may take: other processes run beside it.
constexpr int kPatience = 30;
/// Factor of the time of a task under a sanitizer.
constexpr int kSanitizedSeconds = 20;

/// Before each text in the pipe.
struct Header {
  std::uint64_t size = 0;
  double seconds = 0;
  End end = End::finished;
};

double used_seconds() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// [bytes] of addresses that the process has.
std::size_t used_addresses() {
  std::ifstream file("/proc/self/statm");
  std::size_t pages = 0;
  file >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

void limit(__rlimit_resource resource, std::size_t soft) {
  rlimit limits{};
  getrlimit(resource, &limits);
  limits.rlim_cur = soft;
  setrlimit(resource, &limits);
}

void send(int pipe, const void* data, std::size_t size) {
  const auto* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t sent = write(pipe, bytes, size);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) _exit(EXIT_FAILURE);
    bytes += sent;
    size -= static_cast<std::size_t>(sent);
  }
}

Outcome outcome_of(const std::function<std::string(std::size_t)>& task, std::size_t index) {
  try {
    return {End::finished, task(index)};
  } catch (const palpate::Error& error) {
    return {End::refused, error.what()};
  } catch (const std::bad_alloc&) {
    return {End::out_of_memory, "std::bad_alloc"};
  } catch (const std::exception& error) {
    return {End::failed, error.what()};
  }
}

[[noreturn]] void work(int pipe, std::size_t first, std::size_t count,
                       const std::function<std::string(std::size_t)>& task, const Limits& limits) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(limits.threads));
  limit(RLIMIT_CORE, 0);
  if (!is_sanitized()) limit(RLIMIT_AS, used_addresses() + limits.bytes);
  const int seconds = limits.seconds * (is_sanitized() ? kSanitizedSeconds : 1);
  for (std::size_t i = first; i < count; ++i) {
    const double begin = used_seconds();
    limit(RLIMIT_CPU, static_cast<std::size_t>(begin) + static_cast<std::size_t>(seconds) + 1);
    const Outcome outcome = outcome_of(task, i);
    const Header header{outcome.text.size(), used_seconds() - begin, outcome.end};
    send(pipe, &header, sizeof header);
    send(pipe, outcome.text.data(), outcome.text.size());
  }
  _exit(EXIT_SUCCESS);
}

enum class Received { all, end_of_file, late };

Received receive(int pipe, void* data, std::size_t size, int milliseconds) {
  auto* bytes = static_cast<char*>(data);
  while (size > 0) {
    pollfd ready{.fd = pipe, .events = POLLIN, .revents = 0};
    const int found = poll(&ready, 1, milliseconds);
    if (found < 0 && errno == EINTR) continue;
    if (found <= 0) return Received::late;
    const ssize_t got = read(pipe, bytes, size);
    if (got <= 0) return Received::end_of_file;
    bytes += got;
    size -= static_cast<std::size_t>(got);
  }
  return Received::all;
}

/// Describes the end of a process that did not report it.
Outcome outcome_of(int status) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU) return {End::out_of_time, "took too much processor time"};
    return {End::crashed, std::string("signal ") + strsignal(signal)};
  }
  return {End::crashed, "exit status " + std::to_string(WEXITSTATUS(status))};
}

}  // namespace

const char* to_string(End end) {
  constexpr std::array kNames = {"finished", "refused",     "failed",
                                 "crashed",  "out of time", "out of memory"};
  return kNames[static_cast<std::size_t>(end)];
}

std::vector<Outcome> run_apart(std::size_t count,
                               const std::function<std::string(std::size_t)>& task,
                               const Limits& limits) {
  const int patience = 1000 * limits.seconds * kPatience * (is_sanitized() ? kSanitizedSeconds : 1);
  std::vector<Outcome> outcomes;
  while (outcomes.size() < count) {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
    std::fflush(nullptr);  // or the child writes it once more
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("no process");
    if (child == 0) {
      close(ends[0]);
      work(ends[1], outcomes.size(), count, task, limits);
    }
    close(ends[1]);
    bool is_late = false;
    while (outcomes.size() < count) {
      Header header;
      Received received = receive(ends[0], &header, sizeof header, patience);
      std::string text(received == Received::all ? header.size : 0, ' ');
      if (received == Received::all)
        received = receive(ends[0], text.data(), text.size(), patience);
      is_late = received == Received::late;
      if (received != Received::all) break;
      outcomes.push_back({header.end, std::move(text), header.seconds});
    }
    close(ends[0]);
    if (is_late) kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    if (is_late) {
      outcomes.push_back({End::out_of_time, "neither works nor ends"});
    } else if (outcomes.size() < count) {
      outcomes.push_back(outcome_of(status));
    }
  }
  return outcomes;
}

bool is_sanitized() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return true;
#else
  return false;
#endif
}

}  // namespace palpate::extremes
