// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "shared/interrupts.h"

namespace palpate::apps {

/// A progress bar on standard error with the estimated time left. It appears only on a terminal and
/// only if the work takes more than a second. While it exists, Ctrl-C and SIGTERM do not kill the
/// process in the middle of a file; instead the next `show` throws. Only one may exist at a time.
class Progress {
 public:
  /// `what` describes the work, such as "decoding".
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Updates the bar. The first call must include work done by an earlier run, which does not count
  /// for the estimated time.
  /// Thread-safe.
  /// \throws Interrupted after Ctrl-C or SIGTERM.
  void show(int done, int total);

 private:
  using Clock = std::chrono::steady_clock;

  InterruptedByThrowing interrupts_;
  std::string what_;
  bool terminal_;
  Clock::time_point start_;
  bool counting_ = false;  // since the first call
  int first_done_ = 0;
  Clock::time_point first_;
  Clock::time_point drawn_;
  bool shown_ = false;
  std::mutex mutex_;
};

}  // namespace palpate::apps
