// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/devices/device.h"
#include "palpate/geometry/eigen_alignment.h"
#include "palpate/probing/force_compensation.h"
#include "palpate/probing/joint_controller.h"

namespace palpate::probing {

/// Each joint is moved up and down over its range, while the others stay in the middle of theirs;
/// the second and third also with the first at the ends of its range.
struct GravityCalibration {
  ArmGeometry geometry;
  Eigen::Vector3d low{-0.5, -0.3, -0.4};  ///< [rad] joints at one end
  Eigen::Vector3d high{0.5, 0.5, 0.4};    ///< [rad] and at the other
  int angles = 15;                        ///< of a joint; >= 3
  double speed = 0.15;                    ///< [rad/s] > 0
  double settling = 0.5;                  ///< [s] before a pose is recorded; >= 0
  double recording = 0.2;                 ///< [s] > 0
  JointGains gains;
};

/// Holds the arm at each pose. The arm must be active and its tip in free space; about seven
/// minutes.
/// \throws InvalidInput on an option outside its range.
/// \throws DeviceError if the arm stops, or does not measure its joints.
[[nodiscard]] std::vector<HeldPose> hold_poses(devices::Device& arm,
                                               const GravityCalibration& calibration = {});

}  // namespace palpate::probing
