// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

namespace palpate::geometry {

/// Whether a pose is a rotation and a finite translation, which its type does not ensure.
[[nodiscard]] inline bool is_rigid(const Eigen::Isometry3d& motion) {
  constexpr double kRotation = 1e-6;  // accepts values rounded to six decimals, as in text files
  return motion.matrix().allFinite() && motion.linear().isUnitary(kRotation) &&
         motion.linear().determinant() > 0;
}

}  // namespace palpate::geometry
