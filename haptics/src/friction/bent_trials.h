// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>
#include <vector>

#include "palpate/haptics/friction_cone.h"

namespace palpate::haptics {

/// Forces whose part f_N along `axis`, a unit vector, became f_N (f_N / force)^exponent where it is
/// positive: the boundary |f_T| = mu f_N (f_N / force)^exponent then is the cone of mu.
[[nodiscard]] inline std::vector<FrictionTrial> bent(std::span<const FrictionTrial> trials,
                                                     const Eigen::Vector3d& axis,
                                                     const FrictionLoad& load) {
  std::vector<FrictionTrial> result(trials.begin(), trials.end());
  if (load.exponent == 0) return result;
  for (FrictionTrial& trial : result) {
    const double normal = trial.force.dot(axis);
    if (normal > 0)
      trial.force += normal * (std::pow(normal / load.force, load.exponent) - 1) * axis;
  }
  return result;
}

}  // namespace palpate::haptics
