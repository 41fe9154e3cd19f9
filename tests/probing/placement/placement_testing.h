// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <numbers>

#include "palpate/probing/arm_placement.h"

/// An arm whose place is known, and the errors of what is found.
namespace palpate::probing::test {

inline constexpr double kTurnDegree = std::numbers::pi / 180;

/// The pose of the arm before the camera.
inline Eigen::Isometry3d stand() {
  return Eigen::Translation3d(20, -190, 480) *
         Eigen::AngleAxisd(1.4, Eigen::Vector3d(1, 0.2, -0.1).normalized());
}

struct PoseError {
  Eigen::Vector3d turn;   ///< [rad]
  Eigen::Vector3d shift;  ///< [mm] of the middle of the measurements
};

inline PoseError error_of(const ArmPlacement& placement) {
  const Eigen::Isometry3d off = placement.T_camera_base * stand().inverse();
  const Eigen::AngleAxisd turn(off.linear());
  return {turn.angle() * turn.axis(), placement.centre - off.inverse() * placement.centre};
}

/// Square of the error in units of the stated covariance; 1 is expected.
inline double squared_ratio(const ArmPlacement& placement) {
  const PoseError error = error_of(placement);
  Eigen::Vector<double, 6> both;
  both << error.turn, error.shift;
  return both.dot(placement.covariance.inverse() * both) / 6;
}

}  // namespace palpate::probing::test
