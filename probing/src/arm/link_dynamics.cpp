// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "arm/link_dynamics.h"

#include <cmath>

namespace palpate::probing {

LinkDynamics link_dynamics(const VirtualArmOptions& o, const Eigen::Vector3d& q,
                           const Eigen::Vector3d& v) {
  const double m1 = o.upper_mass * kKilogram, m2 = o.lower_mass * kKilogram;
  const double l1 = o.geometry.upper, a1 = l1 / 2, a2 = o.geometry.lower / 2;
  const double s0 = std::sin(q[0]), c0 = std::cos(q[0]), s1 = std::sin(q[1]), c1 = std::cos(q[1]);
  const double s1u = std::sin(q[1] + o.upper_angle), c1u = std::cos(q[1] + o.upper_angle);
  const double s2 = std::sin(q[2] + o.lower_angle), c2 = std::cos(q[2] + o.lower_angle);
  const double r1 = a1 * c1u, r2 = l1 * c1 + a2 * s2;  // [mm] radii of the masses
  const double m12 = m2 * l1 * a2 * (c1 * s2 - s1 * c2);
  const double m12_q1 = -m2 * l1 * a2 * (s1 * s2 + c1 * c2), m12_q2 = -m12_q1;
  const double m00_q1 = 2 * (m1 * r1 * -a1 * s1u + m2 * r2 * -l1 * s1);
  const double m00_q2 = 2 * m2 * r2 * a2 * c2;
  LinkDynamics d;
  d.inertia.diagonal() = o.rotor * kKilogram;
  d.inertia(0, 0) += m1 * r1 * r1 + m2 * r2 * r2;
  d.inertia(1, 1) += m1 * a1 * a1 + m2 * l1 * l1;
  d.inertia(2, 2) += m2 * a2 * a2;
  d.inertia(1, 2) = d.inertia(2, 1) = m12;
  d.bias << (m00_q1 * v[1] + m00_q2 * v[2]) * v[0], m12_q2 * v[2] * v[2] - m00_q1 * v[0] * v[0] / 2,
      m12_q1 * v[1] * v[1] - m00_q2 * v[0] * v[0] / 2;
  const Eigen::Vector3d& g = o.gravity;
  const double outwards = g.x() * s0 + g.z() * c0;
  d.bias -= Eigen::Vector3d(
      (m1 * r1 + m2 * r2) * (g.x() * c0 - g.z() * s0),
      m1 * (-outwards * a1 * s1u + g.y() * a1 * c1u) + m2 * (-outwards * l1 * s1 + g.y() * l1 * c1),
      m2 * (outwards * a2 * c2 + g.y() * a2 * s2));
  return d;
}

}  // namespace palpate::probing
