// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/deformable_body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

void check_supports(const DeformableBody& body) {
  const Eigen::Index nodes = body.mesh.nodes.cols();
  for (const int node : body.supported) {
    if (node >= 0 && node < nodes) continue;
    throw InvalidInput("DeformableBody::supported has node " + std::to_string(node) +
                       "; there are " + std::to_string(nodes));
  }
  const auto supports = static_cast<Eigen::Index>(body.supported.size());
  if (body.support_moves.size() != 0 && body.support_moves.cols() != supports) {
    throw InvalidInput("DeformableBody::support_moves has " +
                       std::to_string(body.support_moves.cols()) +
                       " columns; it must have one for each of the " + std::to_string(supports) +
                       " supported nodes, or none");
  }
  if (!body.support_moves.allFinite())
    throw InvalidInput("DeformableBody::support_moves is not finite");
}

// Each part of the solid, which elements connect, needs three supports that do not lie in a line.
void check_parts_are_held(const DeformableBody& body) {
  const Eigen::Index nodes = body.mesh.nodes.cols();
  std::vector<int> part(static_cast<std::size_t>(nodes));
  for (std::size_t n = 0; n < part.size(); ++n) part[n] = static_cast<int>(n);
  const auto find = [&](int n) {
    while (part[static_cast<std::size_t>(n)] != n)
      n = part[static_cast<std::size_t>(n)] =
          part[static_cast<std::size_t>(part[static_cast<std::size_t>(n)])];
    return n;
  };
  for (Eigen::Index e = 0; e < body.mesh.elements.cols(); ++e)
    for (const int node : body.mesh.elements.col(e))
      part[static_cast<std::size_t>(find(node))] = find(body.mesh.elements(0, e));
  std::vector<std::vector<int>> held(part.size());
  for (const int node : body.supported) held[static_cast<std::size_t>(find(node))].push_back(node);
  constexpr double kLine = 1e-6;  // sine of the angle below which three nodes are in a line
  for (std::size_t n = 0; n < part.size(); ++n) {
    if (find(static_cast<int>(n)) != static_cast<int>(n)) continue;
    const std::vector<int>& nodes_held = held[n];
    bool enough = false;
    for (std::size_t k = 2; k < nodes_held.size() && !enough; ++k) {
      const Vector3d a = body.mesh.nodes.col(nodes_held[1]) - body.mesh.nodes.col(nodes_held[0]);
      const Vector3d b = body.mesh.nodes.col(nodes_held[k]) - body.mesh.nodes.col(nodes_held[0]);
      enough = a.cross(b).norm() > kLine * a.norm() * b.norm();
    }
    if (enough) continue;
    throw InvalidInput("the part of the object with node " + std::to_string(n) + " has " +
                       std::to_string(nodes_held.size()) +
                       " supported nodes; it must have three or more that do not lie in a line");
  }
}

}  // namespace

void check_deformable_body(const DeformableBody& body) {
  check_finite_element_mesh(body.mesh);
  for (const Hyperelastic& material : body.materials) check_hyperelastic(material);
  for (std::size_t e = 0; e < body.mesh.regions.size(); ++e) {
    if (static_cast<std::size_t>(body.mesh.regions[e]) < body.materials.size()) continue;
    throw InvalidInput("element " + std::to_string(e) + " is in region " +
                       std::to_string(body.mesh.regions[e]) + "; there are materials for " +
                       std::to_string(body.materials.size()) + " regions");
  }
  check_supports(body);
  check_parts_are_held(body);
  for (const RigidBlock& block : body.obstacles) {
    for (int axis = 0; axis < 3; ++axis) {
      const double side = block.high[axis] - block.low[axis];
      require("RigidBlock::high - low", side, above(0).finite(), "mm");
      require("RigidBlock::rounding", block.rounding, above(0).at_most(side / 2), "mm");
    }
  }
}

double largest_modulus(const DeformableBody& body) {
  double modulus = 0;
  for (const Hyperelastic& material : body.materials)
    modulus = std::max(modulus, young_modulus(material));
  return modulus;
}

}  // namespace palpate::probing
