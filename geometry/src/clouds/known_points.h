// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "base/numbers.h"
#include "palpate/core/error.h"

namespace palpate::geometry {

/// [mm] Coordinates whose squares and their sums stay far from overflow.
inline constexpr double kLargestCoordinate = 1e100;

/// Indices of the points (3 x N) that are finite, ascending.
/// \throws InvalidInput naming a point whose coordinates exceed kLargestCoordinate, or if there are
/// 2^31 points or more.
[[nodiscard]] inline std::vector<int> known_points(
    const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  if (points.cols() > std::numeric_limits<int>::max())
    throw InvalidInput("points: there are " + std::to_string(points.cols()) +
                       "; a cloud has fewer than 2^31. Divide it.");
  std::vector<int> known;
  known.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const double largest = points.col(i).cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
    if (!(largest < kInfinity)) continue;
    if (largest > kLargestCoordinate)
      throw InvalidInput("point " + std::to_string(i) +
                         ": has a coordinate beyond 1e100 mm; is the unit right?");
    known.push_back(static_cast<int>(i));
  }
  return known;
}

}  // namespace palpate::geometry
