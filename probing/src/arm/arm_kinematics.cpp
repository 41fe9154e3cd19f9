// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/arm_kinematics.h"

#include <cmath>

namespace palpate::probing {

Eigen::Vector3d tip_position(const ArmGeometry& geometry, const Eigen::Vector3d& joints) noexcept {
  const double r = geometry.upper * std::cos(joints[1]) + geometry.lower * std::sin(joints[2]);
  const double y = geometry.upper * std::sin(joints[1]) - geometry.lower * std::cos(joints[2]);
  return {r * std::sin(joints[0]), y, r * std::cos(joints[0])};
}

std::optional<Eigen::Vector3d> joints_at(const ArmGeometry& geometry,
                                         const Eigen::Vector3d& tip) noexcept {
  // In a vertical plane this is an arm of two links, elbow up. The angle of the lower link is that
  // of joint 2 minus pi / 2.
  const double l1 = geometry.upper, l2 = geometry.lower;
  const double r = std::hypot(tip.x(), tip.z());
  const double bend = (r * r + tip.y() * tip.y() - l1 * l1 - l2 * l2) / (2 * l1 * l2);  // a cosine
  if (!(r > 0) || !(std::abs(bend) < 1)) return std::nullopt;
  const double elbow = std::atan2(-std::sqrt((1 - bend) * (1 + bend)), bend);
  const double joint1 = std::atan2(tip.y(), r) - std::atan2(l2 * std::sin(elbow), l1 + l2 * bend);
  constexpr double kQuarter = 1.5707963267948966;
  return Eigen::Vector3d(std::atan2(tip.x(), tip.z()), joint1, joint1 + elbow + kQuarter);
}

Eigen::Matrix3d arm_jacobian(const ArmGeometry& geometry, const Eigen::Vector3d& joints) noexcept {
  const double s0 = std::sin(joints[0]), c0 = std::cos(joints[0]);
  const double s1 = std::sin(joints[1]), c1 = std::cos(joints[1]);
  const double s2 = std::sin(joints[2]), c2 = std::cos(joints[2]);
  const double l1 = geometry.upper, l2 = geometry.lower;
  const double r = l1 * c1 + l2 * s2;
  Eigen::Matrix3d jacobian;
  jacobian << r * c0, -l1 * s1 * s0, l2 * c2 * s0,  //
      0, l1 * c1, l2 * s2,                          //
      -r * s0, -l1 * s1 * c0, l2 * c2 * c0;
  return jacobian;
}

}  // namespace palpate::probing
