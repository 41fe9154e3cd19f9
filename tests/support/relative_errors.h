// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace palpate::geometry::test {

struct RelativeErrors {
  double mean = 0;
  double max = 0;
};

/// Errors relative to true distances, for vertices farther from the source than `near`.
inline RelativeErrors relative_errors(const Eigen::VectorXd& measured, const Eigen::VectorXd& truth,
                                      double near) {
  RelativeErrors errors;
  int count = 0;
  for (Eigen::Index v = 0; v < truth.size(); ++v) {
    if (truth[v] <= near) continue;
    const double error = std::abs(measured[v] - truth[v]) / truth[v];
    errors.max = std::max(errors.max, error);
    errors.mean += error;
    ++count;
  }
  errors.mean /= count;
  return errors;
}

}  // namespace palpate::geometry::test
