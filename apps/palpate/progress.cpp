// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "progress.h"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <utility>

namespace palpate::apps {
namespace {

volatile std::sig_atomic_t interrupted = 0;

constexpr int kBarWidth = 40;                        // characters
constexpr auto kPatience = std::chrono::seconds(1);  // shorter work shows no bar

void watch_for_interrupt() {
  // A second Ctrl-C kills at once.
  struct sigaction action = {};
  action.sa_handler = [](int) { interrupted = 1; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

Progress::Progress(std::string what)
    : what_(std::move(what)),
      terminal_(isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()) {
  watch_for_interrupt();
}

Progress::~Progress() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  if (shown_) std::fputs("\r\x1b[K", stderr);
}

void Progress::show(int done, int total) {
  if (interrupted != 0) throw Interrupted{};
  if (!terminal_ || total <= 0 || std::chrono::steady_clock::now() - start_ < kPatience) return;
  const std::lock_guard lock(mutex_);
  const int filled = kBarWidth * done / total;
  std::fprintf(stderr, "\r%s [%s%s] %d of %d", what_.c_str(),
               std::string(static_cast<std::size_t>(filled), '#').c_str(),
               std::string(static_cast<std::size_t>(kBarWidth - filled), ' ').c_str(), done, total);
  std::fflush(stderr);
  shown_ = true;
}

}  // namespace palpate::apps
