// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <deque>

namespace palpate::probing {

// Improves the steps of Newton's method with an old matrix by what its last steps have shown
// (Anderson 1965).
class AndersonAcceleration {
 public:
  // A better step than `step`, the one that the old matrix proposes.
  Eigen::VectorXd improved(const Eigen::VectorXd& step);
  // Must be called with the step that was taken, before the next call of `improved`.
  void took(const Eigen::VectorXd& step);
  // Forgets all steps; to be called when the matrix changes.
  void clear();

 private:
  std::deque<Eigen::VectorXd> taken_, changes_;
  Eigen::VectorXd last_;
};

}  // namespace palpate::probing
