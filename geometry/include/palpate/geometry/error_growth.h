// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace palpate::geometry {

/// Exponent of the mean squared distance to contacts in the squared error of what is interpolated
/// between them. The error of the nearest contact's value grows as if it were 1, that of linear
/// interpolation as if it were 2. Errors of several objects agree best in between
/// (docs/trade-model.md).
inline constexpr double kErrorGrowth = 1.25;
/// How much more a squared distance beyond the contacts counts, where the place is not between
/// them: values are continued there, not interpolated.
inline constexpr double kBeyondGrowth = 2;

/// [mm^2] The squared distance with which errors grow at a place x, from contacts x_k with weights
/// w_k.
/// \param mean_square [mm^2] sum_k w_k |x - x_k|^2. \param beyond_square [mm^2] |sum_k w_k (x -
/// x_k)|^2 along the surface, which is part of it.
[[nodiscard]] inline double error_reach(double mean_square, double beyond_square) {
  return mean_square + (kBeyondGrowth - 1) * beyond_square;
}

/// [mm^2.5] What squared errors are proportional to.
[[nodiscard]] inline double error_growth(double reach) { return std::pow(reach, kErrorGrowth); }

}  // namespace palpate::geometry
