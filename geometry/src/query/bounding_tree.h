// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "query/triangle_packet.h"

namespace palpate::geometry {

/// Four boxes side by side, one a child.
struct TreeNode {
  /// [axis][0]: lower, [axis][1]: upper; lower > upper without a child
  std::array<std::array<Lanes, 2>, 3> sides;
  std::array<int, TrianglePacket::kSize> child;  ///< >= 0: node; < 0: packet ~child
  unsigned children = 0;                         ///< bit i is set iff there is a child i
};

/// A bounding volume hierarchy whose leaves are packets of triangles. It is built by Embree
/// (surface area heuristic) and walked here: four boxes or four triangles a step, without
/// a call back.
struct BoundingTree {
  /// A walk that puts off all other children on the way down puts off 3 a level.
  static constexpr int kMaxDepth = 64;

  std::vector<TreeNode> nodes;  ///< the root first, parents before their children
  std::vector<TrianglePacket> packets;
};

/// \param vertices 3 x V, local frame. \param margin boxes are larger by it on all sides.
/// \throws SolverError if Embree fails.
[[nodiscard]] BoundingTree build_tree(const Eigen::Matrix3Xd& vertices,
                                      const Eigen::Matrix3Xi& triangles, double margin);

/// Fits packets and boxes to vertices that have moved.
void refit(BoundingTree& tree, const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
           double margin);

/// What a walk down the tree costs: the areas of the boxes relative to that of the root, which is
/// the chance that a line through the root meets them (MacDonald and Booth 1990).
[[nodiscard]] double walking_cost(const BoundingTree& tree);

}  // namespace palpate::geometry
