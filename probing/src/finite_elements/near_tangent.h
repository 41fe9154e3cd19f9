// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/LU>

#include "finite_elements/contact_newton.h"

// The linear systems of an equilibrium: motions of nodes and tip that balance forces.
namespace palpate::probing {

// Returns the unbalanced forces: 3 N on nodes, then that on the tip [N].
[[nodiscard]] Eigen::VectorXd missing_forces(const SystemForces& forces, const ContactStep& step);

// The system of Newton's method, with old factors of the solid and the contact as it is.
class NearTangent {
 public:
  NearTangent(const ContactSystem& system, const PlaceFactors& place, const NestedFactors& factors,
              const SystemForces& forces, ContactGoal goal);

  // Motions of all nodes and of the tip, one after the other [mm], that such forces cause [N].
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& forces) const;

 private:
  const PlaceFactors& place_;
  const NestedFactors& factors_;
  bool tip_moves_;
  Eigen::PartialPivLU<Eigen::MatrixXd> root_;
};

// The point of the tangent: positions of nodes and tip [mm], and the forces there.
struct TangentPoint {
  const Eigen::Matrix3Xd& positions;
  const Eigen::Vector3d& tip;
  const SystemForces& forces;
};

// The true tangent times motions of all nodes and of the tip, by a difference of forces. `radius`
// [mm] is that of the tip. Not finite if elements are inverted.
[[nodiscard]] Eigen::VectorXd tangent_product(const ContactSystem& system, double radius,
                                              const ContactState& start, const ContactStep& step,
                                              const TangentPoint& at,
                                              const Eigen::VectorXd& motion);

}  // namespace palpate::probing
