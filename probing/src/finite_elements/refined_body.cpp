// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "finite_elements/finite_element_tools.h"
#include "palpate/probing/contact_equilibrium.h"

namespace palpate::probing {
namespace {

using Corners = std::array<int, 4>;  // local nodes of a parent that are corners of a part

Eigen::Vector4d place_of(int node) {
  if (node < 4) return Eigen::Vector4d::Unit(node);
  const auto& ends = kEdgeCorners[node - 4];
  return (Eigen::Vector4d::Unit(ends[0]) + Eigen::Vector4d::Unit(ends[1])) / 2;
}

// The parts of a tetrahedron: one at each corner, and four about the shortest diagonal of the
// octahedron between them.
std::array<Corners, 8> parts_of(const ElementNodes& nodes) {
  constexpr int kDiagonals[3][2] = {{4, 9}, {5, 7}, {6, 8}};  // middles of opposite edges
  int shortest = 0;
  double least = 0;
  for (int d = 0; d < 3; ++d) {
    const double length = (nodes.col(kDiagonals[d][0]) - nodes.col(kDiagonals[d][1])).norm();
    if (d > 0 && !(length < least)) continue;
    shortest = d;
    least = length;
  }
  const auto& [a, b] = kDiagonals[shortest];
  const auto& [c, opposite_c] = kDiagonals[(shortest + 1) % 3];
  const auto& [d, opposite_d] = kDiagonals[(shortest + 2) % 3];
  return {Corners{0, 4, 6, 7},
          Corners{4, 1, 5, 8},
          Corners{6, 5, 2, 9},
          Corners{7, 8, 9, 3},
          Corners{a, b, c, d},
          Corners{a, b, d, opposite_c},
          Corners{a, b, opposite_c, opposite_d},
          Corners{a, b, opposite_d, c}};
}

// Nodes of the finer mesh that are new, in the middle of two nodes of the coarse one.
class MiddleNodes {
 public:
  explicit MiddleNodes(const DeformableBody& body)
      : body_(body),
        next_(static_cast<int>(body.mesh.nodes.cols())),
        support_(body.mesh.nodes.cols(), -1) {
    for (std::size_t k = 0; k < body.supported.size(); ++k)
      support_[static_cast<std::size_t>(body.supported[k])] = static_cast<int>(k);
  }

  int between(Eigen::Index element, int a, int b) {
    const auto nodes = body_.mesh.elements.col(element);
    const auto [at, is_new] = index_.try_emplace(std::minmax(nodes[a], nodes[b]), next_);
    if (!is_new) return at->second;
    ++next_;
    const Eigen::Matrix<double, 10, 1> shape = shape_functions((place_of(a) + place_of(b)) / 2);
    positions.emplace_back(element_nodes(body_.mesh, body_.mesh.nodes, element) * shape);
    // It is held if all nodes that move it are.
    Eigen::Vector3d move = Eigen::Vector3d::Zero();
    bool held = true;
    for (int n = 0; n < 10 && held; ++n) {
      if (shape[n] == 0) continue;
      const int support = support_[static_cast<std::size_t>(nodes[n])];
      held = support >= 0;
      if (held && body_.support_moves.size() != 0)
        move += shape[n] * body_.support_moves.col(support);
    }
    if (held) {
      supported.push_back(at->second);
      moves.push_back(move);
    }
    return at->second;
  }

  std::vector<Eigen::Vector3d> positions, moves;
  std::vector<int> supported;

 private:
  const DeformableBody& body_;
  int next_;
  std::vector<int> support_;  // of each coarse node; -1: none
  std::map<std::pair<int, int>, int> index_;
};

}  // namespace

DeformableBody refined(const DeformableBody& body) {
  const FiniteElementMesh& coarse = body.mesh;
  DeformableBody result = body;
  MiddleNodes middles(body);
  result.mesh.elements.resize(10, 8 * coarse.elements.cols());
  result.mesh.regions.clear();
  Eigen::Index next = 0;
  for (Eigen::Index e = 0; e < coarse.elements.cols(); ++e) {
    for (Corners corners : parts_of(element_nodes(coarse, coarse.nodes, e))) {
      Eigen::Matrix<double, 3, 4> places;
      for (int k = 0; k < 4; ++k)
        places.col(k) = place_of(corners[static_cast<std::size_t>(k)]).tail<3>();
      const Eigen::Matrix3d edges = places.rightCols<3>().colwise() - places.col(0);
      if (edges.determinant() < 0) std::swap(corners[2], corners[3]);
      auto part = result.mesh.elements.col(next++);
      for (std::size_t k = 0; k < 4; ++k)
        part[static_cast<Eigen::Index>(k)] = coarse.elements(corners[k], e);
      for (int m = 0; m < 6; ++m)
        part[4 + m] = middles.between(e, corners[static_cast<std::size_t>(kEdgeCorners[m][0])],
                                      corners[static_cast<std::size_t>(kEdgeCorners[m][1])]);
      result.mesh.regions.push_back(coarse.regions[static_cast<std::size_t>(e)]);
    }
  }
  const auto added = std::ssize(middles.positions);
  result.mesh.nodes.conservativeResize(3, coarse.nodes.cols() + added);
  for (Eigen::Index n = 0; n < added; ++n)
    result.mesh.nodes.col(coarse.nodes.cols() + n) = middles.positions[static_cast<std::size_t>(n)];
  result.supported.insert(result.supported.end(), middles.supported.begin(),
                          middles.supported.end());
  if (body.support_moves.size() != 0) {
    const auto before = body.support_moves.cols();
    result.support_moves.conservativeResize(3, std::ssize(result.supported));
    for (std::size_t k = 0; k < middles.moves.size(); ++k)
      result.support_moves.col(before + static_cast<Eigen::Index>(k)) = middles.moves[k];
  }
  return result;
}

}  // namespace palpate::probing
