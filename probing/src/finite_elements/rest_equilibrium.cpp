// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/rest_equilibrium.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "finite_elements/contact_newton.h"
#include "finite_elements/deformable_body.h"
#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kRestTolerance = 1e-10;  // unbalanced forces over those of supports

// Solves K x = b, in place, with the tangent K at the given positions.
void solve_tangent(const ContactSystem& system, const PlaceFactors& place,
                   const Eigen::Matrix3Xd& positions, Eigen::VectorXd& vector) {
  NestedFactors factors;
  factor_place(system, place, positions, factors);
  substitute_forward(place.tree, factors, vector);
  substitute_backward(place.tree, factors, vector);
}

// The linear answer of the solid to a motion of its supports by a part of their paths. With it, no
// element beside a support is inverted by the motion.
Eigen::Matrix3Xd move_supports(const DeformableBody& body, const ContactSystem& system,
                               const PlaceFactors& place, const Eigen::Matrix3Xd& positions,
                               double part) {
  const auto fixed = [&](Eigen::Index n) { return system.fixed()[static_cast<std::size_t>(n)]; };
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(positions.size());
  for (std::size_t k = 0; k < body.supported.size(); ++k)
    motion.segment<3>(3 * body.supported[k]) =
        part * body.support_moves.col(static_cast<Eigen::Index>(k));
  Eigen::VectorXd change = Eigen::VectorXd::Zero(positions.size());
  for (int e = 0; e < body.mesh.elements.cols(); ++e) {
    const auto element = body.mesh.elements.col(e);
    if (std::none_of(element.begin(), element.end(), fixed)) continue;
    const ElementMatrix tangent = system.tangent(positions, e);
    for (int a = 0; a < 10; ++a)
      for (int b = 0; b < 10; ++b)
        change.segment<3>(3 * element[a]) -=
            tangent.block<3, 3>(3 * a, 3 * b) * motion.segment<3>(3 * element[b]);
  }
  solve_tangent(system, place, positions, change);
  Eigen::Matrix3Xd moved = positions;
  for (Eigen::Index n = 0; n < positions.cols(); ++n)
    moved.col(n) += fixed(n) ? motion.segment<3>(3 * n) : change.segment<3>(3 * n);
  return moved;
}

// Returns true if Newton's method found the equilibrium near `positions`.
bool settle(const ContactSystem& system, const PlaceFactors& place, int max_iterations,
            double least_scale, Eigen::Matrix3Xd& positions) {
  const Vector3d no_tip = Vector3d::Zero();
  SystemForces forces = system.forces(positions, no_tip, nullptr);
  for (int i = 0; i < max_iterations && forces.valid; ++i) {
    if (forces.nodes.norm() <= kRestTolerance * std::max(forces.reaction, least_scale)) return true;
    Eigen::VectorXd change = -forces.nodes;
    solve_tangent(system, place, positions, change);
    positions += Eigen::Map<const Eigen::Matrix3Xd>(change.data(), 3, positions.cols());
    forces = system.forces(positions, no_tip, nullptr);
  }
  return false;
}

}  // namespace

Eigen::Matrix3Xd rest_equilibrium(const DeformableBody& body, const ContactSystem& system,
                                  const EquilibriumOptions& options) {
  Eigen::Matrix3Xd rest = body.mesh.nodes;
  const bool moves = body.support_moves.size() != 0;
  if (!moves && body.obstacles.empty()) return rest;
  const PlaceFactors place = order_unknowns(system, rest, Vector3d::Zero(), 0);
  // Rounding leaves forces where nothing moved; E R^2 is the scale of forces then.
  const double least_scale = largest_modulus(body) * options.tip_radius * options.tip_radius;
  const double least_step = std::ldexp(1.0, -options.max_halvings);
  double done = 0, step = 1;  // of the motions of the supports
  while (done < 1) {
    const double next = std::min(1.0, done + step);
    Eigen::Matrix3Xd positions =
        moves ? move_supports(body, system, place, rest, next - done) : rest;
    if (settle(system, place, options.max_iterations, least_scale, positions)) {
      rest = positions;
      done = next;
    } else if (step /= 2; step < least_step) {
      throw SolverError("the object has no equilibrium after its supports have moved by " +
                        std::to_string(100 * next) +
                        " % of their ways; move them less, or refine the mesh beside them");
    }
  }
  return rest;
}

}  // namespace palpate::probing
