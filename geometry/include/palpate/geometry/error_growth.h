// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace palpate::geometry {

/// Squared errors of interpolation between contacts grow with this power of the mean squared
/// distance to the contacts. The exponent would be 1 for the value of the nearest contact, and 2
/// for linear interpolation. Errors of several objects agree best with a value in between
/// (docs/trade-model.md).
inline constexpr double kErrorGrowth = 1.25;
/// Factor by which a squared distance beyond the contacts counts more, at a place that is not
/// between them: there, values are extrapolated, not interpolated.
inline constexpr double kBeyondGrowth = 2;

/// [mm^2] The squared distance with which errors grow at a place x, from contacts x_k with weights
/// w_k.
/// \param mean_square [mm^2] sum_k w_k |x - x_k|^2. \param beyond_square [mm^2] |sum_k w_k (x -
/// x_k)|^2 along the surface, which is part of it.
[[nodiscard]] inline double error_reach(double mean_square, double beyond_square) {
  return mean_square + (kBeyondGrowth - 1) * beyond_square;
}

/// [mm^2.5] A quantity to which squared errors are proportional.
[[nodiscard]] inline double error_growth(double reach) { return std::pow(reach, kErrorGrowth); }

}  // namespace palpate::geometry
