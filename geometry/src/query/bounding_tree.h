// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "query/triangle_packet.h"

namespace palpate::geometry {

/// Processors load memory in lines of this size.
inline constexpr std::size_t kCacheLine = 64;

/// Four boxes side by side, one per child; two cache lines.
struct alignas(kCacheLine) TreeNode {
  /// [axis][0]: lower, [axis][1]: upper; lower > upper if there is no child
  std::array<std::array<Lanes, 2>, 3> sides;
  std::array<int, TrianglePacket::kSize> child;  ///< >= 0: node; < 0: packet ~child
  unsigned children = 0;                         ///< bit i is set iff there is a child i
};

/// A bounding volume hierarchy whose leaves are packets of triangles. Embree builds it (surface
/// area heuristic); our own traversal tests four boxes or four triangles per step without
/// callbacks.
struct BoundingTree {
  /// A traversal defers at most 3 children per level on the way down.
  static constexpr int kMaxDepth = 64;

  std::vector<TreeNode> nodes;  ///< root first, parents before their children
  std::vector<TrianglePacket> packets;
};

/// Builds the tree.
/// \param vertices 3 x V, local frame.
/// \param margin by which boxes are enlarged on all sides.
/// \throws SolverError if Embree fails.
[[nodiscard]] BoundingTree build_tree(const Eigen::Matrix3Xd& vertices,
                                      const Eigen::Matrix3Xi& triangles, double margin);

/// Updates packets and boxes after vertices have moved.
void refit(BoundingTree& tree, const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
           double margin);

/// Expected cost of a traversal: the areas of the boxes relative to the root's, which is the
/// probability that a line through the root hits them (MacDonald and Booth 1990).
[[nodiscard]] double walking_cost(const BoundingTree& tree);

}  // namespace palpate::geometry
