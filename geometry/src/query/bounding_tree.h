// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "query/huge_pages.h"
#include "query/triangle_packet.h"

namespace palpate::geometry {

/// Processors load memory in lines of this size.
inline constexpr std::size_t kCacheLine = 64;

/// One number for each of eight boxes, the children of a node.
template <typename Number>
using ChildLanes = Eigen::Array<Number, 8, 1>;
using BoxLanes = ChildLanes<float>;

/// Bit i is set iff a[i] <= b[i].
inline unsigned where_not_above(const BoxLanes& a, const BoxLanes& b) {
  const auto half = [&](int first) {
    return where_not_above(Lanes(a.segment<4>(first)), Lanes(b.segment<4>(first)));
  };
  return half(0) | half(4) << 4;
}

inline unsigned where_not_above(const ChildLanes<double>& a, const ChildLanes<double>& b) {
  unsigned bits = 0;
  for (int i = 0; i < 8; ++i) bits |= static_cast<unsigned>(a[i] <= b[i]) << i;
  return bits;
}

/// Eight boxes side by side, one per child; four cache lines.
struct alignas(kCacheLine) TreeNode {
  static constexpr int kSize = 8;
  /// [axis][0]: lower, [axis][1]: upper; lower > upper if there is no child
  std::array<std::array<BoxLanes, 2>, 3> sides;
  std::array<int, kSize> child;  ///< >= 0: node; < 0: packet ~child
  unsigned children = 0;         ///< bit i is set iff there is a child i
};

/// A bounding volume hierarchy whose leaves are packets of triangles. Embree builds it (surface
/// area heuristic); our own traversal tests eight boxes or four triangles per step without
/// callbacks.
struct BoundingTree {
  /// A traversal defers at most 7 children per level on the way down.
  static constexpr int kMaxDepth = 64;

  std::vector<TreeNode, HugePages<TreeNode>> nodes;  ///< root first, parents before their children
  std::vector<TrianglePacket, HugePages<TrianglePacket>> packets;
};

/// Quality of a tree; its answers are the same either way.
enum class TreeBuild {
  thorough,  ///< for many queries
  quick      ///< for few: see quick_tree.h
};

/// Builds the tree.
/// \param vertices 3 x V, local frame.
/// \param margin by which boxes are enlarged on all sides.
/// \throws SolverError if Embree fails.
[[nodiscard]] BoundingTree build_tree(const Eigen::Matrix3Xd& vertices,
                                      const Eigen::Matrix3Xi& triangles, double margin,
                                      TreeBuild build = TreeBuild::thorough);

/// Updates packets and boxes after vertices have moved.
void refit(BoundingTree& tree, const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
           double margin);

/// Expected cost of a traversal: the areas of the boxes relative to the root's, which is the
/// probability that a line through the root hits them (MacDonald and Booth 1990).
[[nodiscard]] double walking_cost(const BoundingTree& tree);

}  // namespace palpate::geometry
