// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

namespace palpate::geometry {

/// Returns true if a pose is a rotation and a finite translation, which its type does not ensure.
[[nodiscard]] inline bool is_rigid(const Eigen::Isometry3d& motion) {
  constexpr double kRotation = 1e-6;  // accepts values rounded to six decimals, as in text files
  return motion.matrix().allFinite() && motion.linear().isUnitary(kRotation) &&
         motion.linear().determinant() > 0;
}

/// The matrix that maps w to v x w.
[[nodiscard]] inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

}  // namespace palpate::geometry
