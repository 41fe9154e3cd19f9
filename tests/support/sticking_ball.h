// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace palpate::support {

/// [mm] Displacement of a rigid ball that sticks where it touches an elastic half-space, under a
/// force [N] whose direction stays the same while it grows (z into the object; Hertz, Mindlin and
/// Deresiewicz). The ring that is touched last carries no shear from before, so the ball moves by
/// 3/2 times as far across as if it were pressed first. No energy has this force as its gradient:
/// pressing harder reduces the displacement across, but a drag does not change the depth.
inline Eigen::Vector3d sticking_ball(const Eigen::Vector3d& force) {
  constexpr double kRadius = 5;    // [mm]
  constexpr double kShear = 0.02;  // [N/mm^2]
  constexpr double kPoisson = 0.475;
  const double modulus = 2 * kShear / (1 - kPoisson);  // [N/mm^2] E / (1 - nu^2)
  const double contact = std::cbrt(3 * force.z() * kRadius / (4 * modulus));  // [mm] its radius
  if (!(contact > 0)) return Eigen::Vector3d::Zero();
  const double across = 1.5 * (2 - kPoisson) / (8 * kShear * contact);  // [mm/N]
  return {across * force.x(), across * force.y(), contact * contact / kRadius};
}

}  // namespace palpate::support
