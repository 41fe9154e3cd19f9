// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

namespace palpate::geometry {

/// Whether a pose is a rotation and a finite shift, as nothing in its type sees to.
[[nodiscard]] inline bool is_rigid(const Eigen::Isometry3d& motion) {
  constexpr double kRotation = 1e-6;  // six decimals, as text files carry them, pass
  return motion.matrix().allFinite() && motion.linear().isUnitary(kRotation) &&
         motion.linear().determinant() > 0;
}

}  // namespace palpate::geometry
