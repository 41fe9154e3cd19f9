// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/reduced_chi2.h"

#include <algorithm>

namespace palpate::haptics {
namespace {

// More than this part of the samples are no outliers but what the fit cannot follow.
constexpr double kMaxOutliers = 0.1;

}  // namespace

ReducedChi2 reduced_chi2(const Eigen::VectorXd& squares, double parameters) {
  ReducedChi2 result;
  double all = 0, inside = 0;
  for (const double square : squares) {
    all += square;
    if (square > kOutlier) {
      ++result.outliers;
    } else {
      inside += square;
    }
  }
  const auto count = static_cast<double>(squares.size());
  const double degrees = 3 * count - parameters;
  result.value = result.outliers <= kMaxOutliers * count
                     ? inside / std::max(1.0, degrees - 3 * result.outliers)
                     : all / std::max(1.0, degrees);
  return result;
}

}  // namespace palpate::haptics
