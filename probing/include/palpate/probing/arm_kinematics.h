// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// Links of a PHANToM: the first joint turns the arm about the vertical y of its base, the others
/// turn the links in a vertical plane. All angles are absolute (thesis Eq 4.2): with c_i, s_i of
/// joint i, the tip has the height y = l_1 s_1 - l_2 c_2 and the radius r = l_1 c_1 + l_2 s_2, and
/// x = r sin(joint 0), z = r cos(joint 0).
struct ArmGeometry {
  double upper = 209.6;  ///< [mm] l_1, > 0
  double lower = 169.5;  ///< [mm] l_2, > 0
};

/// [mm] \param joints [rad]
[[nodiscard]] Eigen::Vector3d tip_position(const ArmGeometry& geometry,
                                           const Eigen::Vector3d& joints) noexcept;

/// [rad] The joints with cos(joint 1 - joint 2) > 0 and r > 0; nothing if the tip [mm] is out of
/// reach, or where the joints are not determined: on the vertical axis, or with an arm stretched.
[[nodiscard]] std::optional<Eigen::Vector3d> joints_at(const ArmGeometry& geometry,
                                                       const Eigen::Vector3d& tip) noexcept;

/// [mm/rad] Derivatives of the tip position: one column for each joint. A force F at the tip and
/// the torques that balance it are related by torques = J^T F.
[[nodiscard]] Eigen::Matrix3d arm_jacobian(const ArmGeometry& geometry,
                                           const Eigen::Vector3d& joints) noexcept;

}  // namespace palpate::probing
