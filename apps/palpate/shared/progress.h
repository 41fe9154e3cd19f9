// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <concepts>
#include <functional>
#include <mutex>
#include <string>

#include "shared/interrupts.h"

namespace palpate::apps {

/// ", 12 min left"
[[nodiscard]] std::string time_left(double seconds);

/// Progress on standard error with the estimated time left, if the work takes more than a second: a
/// bar on a terminal; elsewhere a line after each tenth of the work. With --quiet there is none, as
/// there are no warnings. While it exists, Ctrl-C and SIGTERM do not kill the process in the middle
/// of a file; instead the next `show` throws. Only one may exist at a time.
class Progress {
 public:
  /// `what` describes the work, such as "decoding".
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Updates the bar, or prints a line. The first call must include work done by an earlier run,
  /// which does not count for the estimated time. Thread-safe.
  /// \throws Interrupted after Ctrl-C or SIGTERM.
  void show(std::integral auto done, std::integral auto total) {
    update(static_cast<int>(done), static_cast<int>(total));
  }

  /// The work of the one that exists, or existed last; empty if there was none.
  [[nodiscard]] static std::string latest();

 private:
  void update(int done, int total);
  void draw_bar(int done, int total, const std::string& left);
  void print_line(int done, int total, const std::string& left);

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
  long long tenths_ = 0;  ///< of the work, for which there are lines
  std::mutex mutex_;
};

/// For an option `progress` of the library: shows the progress from the first call to the one with
/// done == total, after which there may be another. See `Progress`.
[[nodiscard]] std::function<void(int done, int total)> shown_as(const std::string& what);

}  // namespace palpate::apps
