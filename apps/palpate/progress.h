// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace palpate::apps {

/// Thrown by `Progress` after Ctrl-C, so that everything on the way out is cleaned up.
struct Interrupted {};

/// Makes Ctrl-C set a mark that `Progress` sees, instead of killing the process in the middle of a
/// file.
void watch_for_interrupt();

/// A progress bar on standard error, shown only on a terminal and only when the work takes more
/// than a second.
class Progress {
 public:
  /// `what` in plain words, such as "decoding".
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Thread-safe.
  /// \throws Interrupted after Ctrl-C.
  void show(int done, int total);

 private:
  std::string what_;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point start_;
  std::mutex mutex_;
};

}  // namespace palpate::apps
