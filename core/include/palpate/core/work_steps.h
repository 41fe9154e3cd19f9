// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>

namespace palpate {

/// Counts the steps of a task and reports them to the `progress` of its options, which may be
/// empty, and which ends the task if it throws.
class WorkSteps {
 public:
  using Progress = std::function<void(int done, int total)>;

  /// \param total largest number of steps, >= 1; they may be fewer.
  WorkSteps(const Progress& progress, int total) : progress_(progress), total_(total) {}

  /// Reports that `more` further steps are done; 0: that the task is still running.
  void tell(int more = 1) {
    done_ = std::min(done_ + more, total_ - 1);
    if (progress_) progress_(done_, total_);
  }

  /// Reports that all steps are done.
  void end() const {
    if (progress_) progress_(total_, total_);
  }

 private:
  const Progress& progress_;
  int done_ = 0;
  int total_;
};

}  // namespace palpate
