// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace palpate::haptics {

/// Dependence of friction coefficients on the normal force f_N along the cone's axis: the factor
/// (f_N / force)^exponent (`friction_limit`).
struct FrictionLoad {
  double exponent = 0;  ///< 0: not at all; in [-0.5, 0.5]
  double force = 1;     ///< [N] at which the coefficients hold; > 0
};

/// A load dependence estimated from trials.
struct FrictionLoadEstimate {
  FrictionLoad load;
  double exponent_error = 0;  ///< standard error
};

/// Largest size of a load exponent: beyond it no contact of solids is known.
inline constexpr double kLargestLoadExponent = 0.5;

/// [N] The largest tangential force that holds under a normal force: mu f_N (f_N / F)^p. It grows
/// with the normal force.
[[nodiscard]] inline double friction_limit(double coefficient, double exponent, double force,
                                           double normal) noexcept {
  const double limit = coefficient * normal;
  return exponent == 0 || !(normal > 0) ? limit : limit * std::pow(normal / force, exponent);
}

}  // namespace palpate::haptics
