// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace palpate::apps {

/// Thrown by `Progress` after Ctrl-C, so that everything on the way out is cleaned up.
struct Interrupted {};

/// A progress bar on standard error, shown only on a terminal and only when the work takes more
/// than a second, with the time that is left if the rest goes as what was done since the first
/// `show`. While there is one, Ctrl-C and SIGTERM do not kill the process in the middle of a file:
/// the next `show` throws. One at a time.
class Progress {
 public:
  /// `what` in plain words, such as "decoding".
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// What an earlier run did belongs into the first call: it tells nothing of how fast this one is.
  /// Thread-safe.
  /// \throws Interrupted after Ctrl-C or SIGTERM.
  void show(int done, int total);

 private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  bool terminal_;
  Clock::time_point start_;
  bool counting_ = false;  // from the first call on
  int first_done_ = 0;
  Clock::time_point first_;
  Clock::time_point drawn_;
  bool shown_ = false;
  std::mutex mutex_;
};

}  // namespace palpate::apps
