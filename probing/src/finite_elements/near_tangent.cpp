// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/near_tangent.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kTangentStep = 1e-6;  // [tip radii] by which forces are compared for the tangent

// The matrix of the root's nodes with the contact. With a force as goal, the three unknowns of the
// tip are its border.
Eigen::MatrixXd root_matrix(const ContactSystem& system, const PlaceFactors& place,
                            const NestedFactors& factors, const SystemForces& forces,
                            ContactGoal goal) {
  const bool tip_moves = goal == ContactGoal::force;
  const Eigen::Index tip = 3 * static_cast<Eigen::Index>(place.problem.root.size());
  const Eigen::Index unknowns = tip + (tip_moves ? 3 : 0);
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(unknowns, unknowns);
  root.topLeftCorner(tip, tip) =
      factors.fronts[static_cast<std::size_t>(place.tree.root_front())].update;
  for (const FaceContact& contact : forces.contacts) {
    const ContactFace& face = system.faces()[static_cast<std::size_t>(contact.face)];
    const auto shape = face.rule->shapes.col(contact.point);
    for (int a = 0; a < 6; ++a) {
      const int row = place.root_index[static_cast<std::size_t>(face.face.nodes[a])];
      if (row < 0) continue;
      for (int b = 0; b < 6; ++b) {
        const int column = place.root_index[static_cast<std::size_t>(face.face.nodes[b])];
        if (column >= 0)
          root.block<3, 3>(3 * row, 3 * column) -= shape[a] * shape[b] * contact.tangent;
      }
      if (tip_moves) {
        root.block<3, 3>(3 * row, tip) += shape[a] * contact.tangent;
        root.block<3, 3>(tip, 3 * row) += shape[a] * contact.tangent;
      }
    }
    if (tip_moves) root.bottomRightCorner<3, 3>() -= contact.tangent;
  }
  return root;
}

}  // namespace

Eigen::VectorXd missing_forces(const SystemForces& forces, const ContactStep& step) {
  Eigen::VectorXd result(forces.nodes.size() + 3);
  result << -forces.nodes,
      (step.goal == ContactGoal::force ? Vector3d(step.target - forces.tip) : Vector3d::Zero());
  return result;
}

NearTangent::NearTangent(const ContactSystem& system, const PlaceFactors& place,
                         const NestedFactors& factors, const SystemForces& forces, ContactGoal goal)
    : place_(place),
      factors_(factors),
      tip_moves_(goal == ContactGoal::force),
      root_(root_matrix(system, place, factors, forces, goal)) {}

Eigen::VectorXd NearTangent::solve(const Eigen::VectorXd& forces) const {
  const std::vector<int>& root_nodes = place_.problem.root;
  const auto tip = static_cast<Eigen::Index>(3 * root_nodes.size());
  Eigen::VectorXd change = forces.head(forces.size() - 3);
  substitute_forward(place_.tree, factors_, change);
  Eigen::VectorXd right(tip + (tip_moves_ ? 3 : 0));
  for (std::size_t k = 0; k < root_nodes.size(); ++k)
    right.segment<3>(static_cast<Eigen::Index>(3 * k)) = change.segment<3>(3 * root_nodes[k]);
  if (tip_moves_) right.tail<3>() = forces.tail<3>();
  const Eigen::VectorXd solved = root_.solve(right);
  for (std::size_t k = 0; k < root_nodes.size(); ++k)
    change.segment<3>(3 * root_nodes[k]) = solved.segment<3>(static_cast<Eigen::Index>(3 * k));
  substitute_backward(place_.tree, factors_, change);
  Eigen::VectorXd whole(forces.size());
  whole << change, (tip_moves_ ? Vector3d(solved.tail<3>()) : Vector3d::Zero());
  return whole;
}

Eigen::VectorXd tangent_product(const ContactSystem& system, double radius,
                                const ContactState& start, const ContactStep& step,
                                const TangentPoint& at, const Eigen::VectorXd& motion) {
  const Eigen::Map<const Eigen::Matrix3Xd> nodes(motion.data(), 3, at.positions.cols());
  const double longest =
      std::sqrt(std::max(nodes.colwise().squaredNorm().maxCoeff(), motion.tail<3>().squaredNorm()));
  const double part = kTangentStep * radius / longest;
  const SystemForces moved =
      system.forces(at.positions + part * nodes, at.tip + part * motion.tail<3>(), &start);
  if (!moved.valid)
    return Eigen::VectorXd::Constant(motion.size(), std::numeric_limits<double>::quiet_NaN());
  return (missing_forces(at.forces, step) - missing_forces(moved, step)) / part;
}

}  // namespace palpate::probing
