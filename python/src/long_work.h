// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <future>

#include "bindings.h"

namespace palpate::python {

/// Work of the library that reports its progress. It runs in a thread of its own: Python hears
/// signals only in its main thread, which may have no part in the work, or a long one.
class LongWork {
 public:
  /// `progress` of Python, or None, must outlive the work.
  explicit LongWork(py::handle progress) : progress_(progress) {}
  LongWork(const LongWork&) = delete;
  LongWork& operator=(const LongWork&) = delete;

  /// For an option `progress`: calls `progress(done, total)` of Python. An exception that it raises
  /// ends the work, and so does Ctrl-C.
  [[nodiscard]] auto report() {
    return [this](int done, int total) {
      go_on();
      if (progress_.is_none()) return;
      const py::gil_scoped_acquire locked;
      progress_(done, total);
    };
  }

  /// To be called by work that has nothing to report. \throws Interrupted after Ctrl-C.
  void go_on() const {
    if (interrupted_) throw Interrupted{};
  }

  /// Calls `work` and returns what it returns. Other threads of Python run meanwhile.
  /// \throws py::error_already_set after Ctrl-C, when the work has ended.
  template <typename Work>
  auto run(const Work& work) {
    auto result = std::async(std::launch::async, [&] { return work(); });
    while (!is_ready(result)) {
      if (PyErr_CheckSignals() == 0) continue;
      const py::error_already_set raised;
      interrupted_ = true;
      while (!is_ready(result)) continue;
      throw raised;  // NOLINT(misc-throw-by-value-catch-by-reference)
    }
    return result.get();
  }

 private:
  struct Interrupted {};
  static constexpr std::chrono::milliseconds kPatience{20};  ///< before signals are heard

  template <typename Result>
  [[nodiscard]] static bool is_ready(const std::future<Result>& result) {
    const Unlocked unlocked;
    return result.wait_for(kPatience) == std::future_status::ready;
  }

  py::handle progress_;
  std::atomic<bool> interrupted_ = false;
};

}  // namespace palpate::python
