// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/probing/arm_kinematics.h"

namespace palpate::probing {

/// Joints held at rest, and what that needed (thesis 4.4.3.1).
struct HeldPose {
  Eigen::Vector3d joints = Eigen::Vector3d::Zero();  ///< [rad]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N mm] of the motors, mean over the hold
  double deviation = 0;  ///< [N mm] standard deviation of the torques over the hold
  /// Of each joint's motion before the hold: 1, -1, or 0 if it did not move; its torque then shows
  /// nothing, because its friction may point either way.
  Eigen::Vector3i direction = Eigen::Vector3i::Zero();
};

/// The torques that gravity asks for, also on a base that is not level: derivatives of a potential
/// whose 12 terms are {1, sin, cos} of joint 0 times {sin, cos} of joints 1 and 2. On a level base
/// each joint's torque is a cosine, as in the thesis.
struct GravityModel {
  Eigen::Matrix<double, 12, 1> potential = Eigen::Matrix<double, 12, 1>::Zero();  ///< [N mm]
  Eigen::Vector3d friction = Eigen::Vector3d::Zero();  ///< [N mm] of each joint
  double residual = 0;                                 ///< [N mm] RMS
};

/// Fits gravity and friction together: friction changes its sign with the direction, gravity does
/// not.
/// \throws InvalidInput if a joint was moved over less than 30 degrees, only one way, or hunted (a
/// deviation above 10 N mm), naming the joint or the pose.
[[nodiscard]] GravityModel fit_gravity(std::span<const HeldPose> poses);

/// [N mm] Torques of the motors that balance gravity.
[[nodiscard]] Eigen::Vector3d gravity_torque(const GravityModel& model,
                                             const Eigen::Vector3d& joints) noexcept;

/// [N] The same as a force of the motors at the tip: J^-T torque.
[[nodiscard]] Eigen::Vector3d gravity_force(const GravityModel& model, const ArmGeometry& geometry,
                                            const Eigen::Vector3d& joints) noexcept;

/// [N] The force that overcomes the arm's own friction (thesis 4.4.3.2): the mean of what the
/// controller needed, besides gravity, to hold the tip in free space just before the contact. It
/// holds for a force along the path on which the tip came.
/// \param held [N] of the controller, one for each tick of at least 0.1 s.
/// \return nothing if a component deviates by more than `largest_deviation` [N]: the joints stick
/// and slip.
/// \throws InvalidInput if there are fewer than 100.
[[nodiscard]] std::optional<Eigen::Vector3d> internal_force(std::span<const Eigen::Vector3d> held,
                                                            double largest_deviation = 0.01);

}  // namespace palpate::probing
