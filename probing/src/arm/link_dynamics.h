// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/probing/virtual_arm.h"

namespace palpate::probing {

constexpr double kKilogram = 1e-3;  // [N s^2/mm]: lengths are in mm, so masses are in 1000 kg

/// Inertia and torques of the links that do not depend on the command.
struct LinkDynamics {
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // [N mm s^2]
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();     // [N mm] inertial and gravity torques
};

/// Lagrange's equations of two point masses and three rotors, at joints `q` [rad] that move with
/// `v` [rad/s]. The mass of the lower link turns about the elbow.
[[nodiscard]] LinkDynamics link_dynamics(const VirtualArmOptions& options, const Eigen::Vector3d& q,
                                         const Eigen::Vector3d& v);

}  // namespace palpate::probing
