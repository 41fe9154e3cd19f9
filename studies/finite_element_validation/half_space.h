// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/probing/contact_equilibrium.h"

// Half a ball in place of a half-space, z <= 0 being outside, with fine cells about the origin.
namespace palpate::bench {

constexpr double kContactRadius = 2;  // [mm] a: of the contact that forces are chosen for

struct HalfSpaceMesh {
  int cells = 4;       // across a box of 2.4 a, even
  double extent = 20;  // [a] radius of the half ball; rounded up to 2.5 a times a power of two
};

// The far side is held or, with a `force` [N] on the origin, moved as that point of a half-space
// that a point force moves (Boussinesq; Cerruti), so that the solid is as soft as a half-space but
// for terms of order (a / extent)^2.
[[nodiscard]] probing::DeformableBody half_space(
    const probing::Hyperelastic& material, const HalfSpaceMesh& mesh,
    const Eigen::Vector3d& force = Eigen::Vector3d::Zero());

// [mm] Displacement of the point `at` of a half-space by a point force [N] on the origin.
[[nodiscard]] Eigen::Vector3d point_force_displacement(const probing::Hyperelastic& material,
                                                       const Eigen::Vector3d& force,
                                                       const Eigen::Vector3d& at);

// A material with Poisson's ratio `nu` and the shear modulus of all cases, 0.04 N/mm^2.
[[nodiscard]] probing::Hyperelastic material_of(double nu);

// [N] The force under which Hertz's contact radius is kContactRadius.
[[nodiscard]] double hertz_force(const probing::Hyperelastic& material, double tip_radius);

}  // namespace palpate::bench
