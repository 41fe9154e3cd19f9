// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "half_space.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "solid_meshes.h"

namespace palpate::bench {

using Eigen::Vector3d;

probing::DeformableBody half_space(const probing::Hyperelastic& material, const HalfSpaceMesh& mesh,
                                   const Vector3d& force) {
  constexpr double kBox = 1.2, kFirstShell = 2.5, kGrowth = 2;  // [a]
  std::vector<double> radii{kFirstShell * kContactRadius};
  while (radii.back() < mesh.extent * kContactRadius) radii.push_back(kGrowth * radii.back());
  probing::DeformableBody body;
  body.mesh = support::half_ball_mesh(kBox * kContactRadius, mesh.cells, radii);
  body.materials = {material};
  constexpr double kOnSphere = 1 - 1e-9;
  support::support_where(body,
                         [&](const Vector3d& at) { return at.norm() > kOnSphere * radii.back(); });
  if (!force.isZero(0))
    support::move_supports(
        body, [&](const Vector3d& at) { return point_force_displacement(material, force, at); });
  return body;
}

// Johnson, Contact Mechanics, 3.2 and 3.6.
Vector3d point_force_displacement(const probing::Hyperelastic& material, const Vector3d& force,
                                  const Vector3d& at) {
  const double nu = probing::poisson_ratio(material), r = at.norm();
  const double part = 1 - 2 * nu, down = r + at.z();
  const Vector3d across(at.x(), at.y(), 0);
  const Vector3d drag(force.x(), force.y(), 0);
  const double along = drag.dot(across);
  Vector3d result = force.z() * (at.z() / (r * r * r) - part / (r * down)) * across;
  result.z() += force.z() * (at.z() * at.z() / (r * r * r) + 2 * (1 - nu) / r);
  result +=
      drag * (1 / r + part / down) + along * (1 / (r * r * r) - part / (r * down * down)) * across;
  result.z() += along * (at.z() / (r * r * r) + part / (r * down));
  return result / (4 * std::numbers::pi * material.shear_modulus);
}

probing::Hyperelastic material_of(double nu) {
  constexpr double kShear = 0.04;
  return {.shear_modulus = kShear, .bulk_modulus = kShear * 2 * (1 + nu) / (3 * (1 - 2 * nu))};
}

double hertz_force(const probing::Hyperelastic& material, double tip_radius) {
  const double nu = probing::poisson_ratio(material);
  const double plane = probing::young_modulus(material) / (1 - nu * nu);
  return 4.0 / 3 * plane * std::pow(kContactRadius, 3) / tip_radius;
}

}  // namespace palpate::bench
