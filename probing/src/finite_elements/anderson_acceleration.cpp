// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/anderson_acceleration.h"

#include <Eigen/Cholesky>
#include <cstddef>

namespace palpate::probing {
namespace {

constexpr std::size_t kDepth = 5;            // steps that are remembered
constexpr double kDependentChanges = 1e-12;  // of the largest diagonal entry of the Gram matrix

}  // namespace

Eigen::VectorXd AndersonAcceleration::improved(const Eigen::VectorXd& step) {
  if (taken_.size() > changes_.size()) changes_.push_back(step - last_);
  if (changes_.size() > kDepth) {
    changes_.pop_front();
    taken_.pop_front();
  }
  last_ = step;
  const auto n = static_cast<Eigen::Index>(changes_.size());
  if (n == 0) return step;
  Eigen::MatrixXd gram(n, n);
  Eigen::VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd& change = changes_[static_cast<std::size_t>(i)];
    right[i] = change.dot(step);
    for (Eigen::Index j = 0; j <= i; ++j)
      gram(i, j) = gram(j, i) = change.dot(changes_[static_cast<std::size_t>(j)]);
  }
  // Without it, nearly dependent changes would get large shares of opposite signs.
  gram.diagonal().array() += kDependentChanges * gram.diagonal().maxCoeff();
  const Eigen::VectorXd share = gram.ldlt().solve(right);
  if (!share.allFinite()) return step;
  Eigen::VectorXd result = step;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    result -= share[i] * (taken_[k] + changes_[k]);
  }
  return result;
}

void AndersonAcceleration::took(const Eigen::VectorXd& step) { taken_.push_back(step); }

void AndersonAcceleration::clear() {
  taken_.clear();
  changes_.clear();
}

}  // namespace palpate::probing
