// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "palpate/probing/closed_form.h"

namespace palpate::probing {

Eigen::Vector3d displacement_beside(const ElasticBody& body, const Eigen::Vector2d& beside,
                                    const Eigen::Vector3d& force) {
  const double nu = body.poisson_ratio, a = body.tool_radius;
  const double shear = body.young_modulus / (2 * (1 + nu));
  const double r = beside.norm();
  const bool below = r <= a;  // the tool
  const Eigen::Vector2d tangential = force.head<2>();
  const Eigen::Vector2d outwards = r > 0 ? Eigen::Vector2d(beside / r) : Eigen::Vector2d::Zero();
  // Integrals over the disc of the tractions of 1 N in all: of 1 / distance, the second derivatives
  // of that of the distance, and the part of the tractions within r.
  const double potential = below ? std::numbers::pi / 2 : std::asin(a / r);
  const double edge = below ? 0 : a * std::sqrt(r * r - a * a) / (r * r);
  const double within = below ? 1 - std::sqrt(1 - r * r / (a * a)) : 1;
  const double compliance = 1 / (4 * std::numbers::pi * shear * a);  // [mm/N]
  const double coupling = r > 0 ? (1 - 2 * nu) * compliance * a / r * within : 0;
  // cos 2 theta and sin 2 theta of the direction of the force against `outwards`
  const Eigen::Vector2d mirrored = 2 * outwards.dot(tangential) * outwards - tangential;
  Eigen::Vector3d moved;
  moved.head<2>() = compliance * ((2 - nu) * potential * tangential + nu * edge * mirrored) -
                    coupling * force.z() * outwards;
  moved.z() =
      2 * (1 - nu) * compliance * potential * force.z() + coupling * outwards.dot(tangential);
  return moved;
}

}  // namespace palpate::probing
