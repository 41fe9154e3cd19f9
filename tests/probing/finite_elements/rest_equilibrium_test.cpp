// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/rest_equilibrium.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "solid_meshes.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

// [N/mm^2] The pressure in an incompressible Mooney-Rivlin shell whose circumference is stretched
// by `inner` and `outer`: the integral of W'(s) / (s^3 - 1), W the energy of an equal biaxial
// stretch s.
double balloon_pressure(const Hyperelastic& material, double inner, double outer) {
  const double c10 = (1 - material.mooney_share) * material.shear_modulus / 2;
  const double c01 = material.mooney_share * material.shear_modulus / 2;
  const auto integral = [&](double s) {
    return 4 * c10 * (-1 / s - 1 / (4 * std::pow(s, 4))) + 4 * c01 * (s - 1 / (2 * s * s));
  };
  return integral(inner) - integral(outer);
}

TEST(RestEquilibrium, AThickBalloonHasItsRadiusAndPressureInClosedForm) {
  constexpr double kInner = 10, kOuter = 15, kInflated = 14;  // [mm]
  const Hyperelastic material{.shear_modulus = 0.3, .bulk_modulus = 1500, .mooney_share = 0.25};
  DeformableBody body;
  body.mesh = palpate::support::spherical_shell_mesh(kInner, kOuter, 4, 2);
  body.materials = {material};
  const auto inside = [&](const Vector3d& at) { return at.norm() < kInner * (1 + 1e-9); };
  palpate::support::support_where(body, inside);
  palpate::support::move_supports(
      body, [&](const Vector3d& at) { return Vector3d((kInflated / kInner - 1) * at); });
  const ContactEquilibrium balloon(body);

  const double outer =
      std::cbrt(std::pow(kOuter, 3) + std::pow(kInflated, 3) - std::pow(kInner, 3));
  const Eigen::Matrix3Xd forces = palpate::support::node_forces(body, balloon.rest());
  double push = 0;
  int outer_nodes = 0;
  for (Eigen::Index n = 0; n < body.mesh.nodes.cols(); ++n) {
    const Vector3d at = body.mesh.nodes.col(n), now = balloon.rest().col(n);
    if (inside(at)) push += forces.col(n).dot(now.normalized());
    if (at.norm() < kOuter * (1 - 1e-9)) continue;
    EXPECT_NEAR(now.norm(), outer, 1e-3 * outer);
    ++outer_nodes;
  }
  EXPECT_EQ(outer_nodes, 6 * 8 * 8 + 2);
  const double pressure = push / (4 * std::numbers::pi * kInflated * kInflated);
  const double exact = balloon_pressure(material, kInflated / kInner, outer / kOuter);
  // 0.2 % too small on elements of 22.5 degrees.
  EXPECT_NEAR(pressure, exact, 3e-3 * exact);
}

}  // namespace
}  // namespace palpate::probing
