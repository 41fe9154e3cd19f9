// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

/// Directions in which displacements show no stiffness.
struct UnmeasuredDirections {
  int count = 0;          ///< 0, 1 or 2
  Eigen::Matrix3d axes;   ///< columns: orthonormal, the unmeasured ones first
  Eigen::Vector3d ridge;  ///< with count = 2: the direction of the forces, of unit length
};

/// A direction is unmeasured if displacements [mm] along it are, in root mean square, at most
/// kRigidRatio times their noise, and the part of the forces [N] along it beyond a linear function
/// of the other displacements is at most kRigidRatio times their noise or a tenth of all forces.
/// More force across would be that of an object that is practically rigid there. One direction at
/// least counts as measured.
[[nodiscard]] UnmeasuredDirections unmeasured_directions(const Eigen::Matrix3Xd& displacements,
                                                         const Eigen::Matrix3Xd& forces,
                                                         double displacement_noise,
                                                         double force_noise);

/// Pairs without what noise alone makes: displacements and forces within the plane that was
/// measured; with a line, both along the direction of the forces.
struct MeasuredPairs {
  Eigen::Matrix3Xd displacements, forces;
};
[[nodiscard]] MeasuredPairs measured_pairs(const Eigen::Matrix3Xd& displacements,
                                           const Eigen::Matrix3Xd& forces,
                                           const UnmeasuredDirections& directions);

/// A field that was fitted to such pairs, with springs along the unmeasured directions, which give
/// it the expected stiffness there. Only the ratios of that count; default: that of a half-space.
/// Does not change forces at displacements in the measured plane or line.
[[nodiscard]] ForceField with_expected_stiffness(ForceField field,
                                                 const Eigen::Matrix3Xd& displacements,
                                                 const UnmeasuredDirections& directions,
                                                 const std::optional<Eigen::Matrix3d>& expected);

}  // namespace palpate::haptics
