// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "arm/link_dynamics.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

/// [mm] Places of the two point masses.
std::array<Vector3d, 2> masses_at(const VirtualArmOptions& o, const Vector3d& q) {
  const auto place = [&](double r, double y) {
    return Vector3d(r * std::sin(q[0]), y, r * std::cos(q[0]));
  };
  const double a1 = o.geometry.upper / 2, a2 = o.geometry.lower / 2;
  const double u = q[1] + o.upper_angle, w = q[2] + o.lower_angle;
  return {place(a1 * std::cos(u), a1 * std::sin(u)),
          place(o.geometry.upper * std::cos(q[1]) + a2 * std::sin(w),
                o.geometry.upper * std::sin(q[1]) - a2 * std::cos(w))};
}

// On a tilted base, by differences of the places of the masses.
TEST(LinkDynamics, IsThatOfTheKineticAndThePotentialEnergy) {
  VirtualArmOptions options;
  options.gravity = {800, -9600, 1500};
  const std::array<double, 2> mass{options.upper_mass * kKilogram, options.lower_mass * kKilogram};
  for (const Vector3d& q : {Vector3d(0, 0, 0), Vector3d(0.4, 0.5, -0.3), Vector3d(-1, -0.2, 0.6)}) {
    const LinkDynamics found = link_dynamics(options, q, Vector3d::Zero());
    constexpr double kStep = 1e-5;  // [rad]
    Eigen::Matrix3d inertia = (options.rotor * kKilogram).asDiagonal();
    Vector3d gravity = Vector3d::Zero();  // [N mm] that the motors must hold
    for (std::size_t i = 0; i < mass.size(); ++i) {
      Eigen::Matrix3d slopes;
      for (int joint = 0; joint < 3; ++joint) {
        const Vector3d way = kStep * Vector3d::Unit(joint);
        slopes.col(joint) =
            (masses_at(options, q + way)[i] - masses_at(options, q - way)[i]) / (2 * kStep);
      }
      inertia += mass[i] * slopes.transpose() * slopes;
      gravity -= mass[i] * slopes.transpose() * options.gravity;
    }
    EXPECT_LT((found.inertia - inertia).norm(), 1e-7 * inertia.norm());
    EXPECT_LT((found.bias - gravity).norm(), 1e-7 * gravity.norm());
  }
}

}  // namespace
}  // namespace palpate::probing
