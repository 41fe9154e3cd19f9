// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "query/bounding_tree.h"

#include <bit>
#include <limits>

#include "palpate/core/parallel_for.h"

namespace palpate::geometry {
namespace {

/// Lower and upper corner of a box.
struct Box {
  Eigen::Array3f lower, upper;
};

Box box_of(const TrianglePacket& packet, float margin) {
  Box box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Lanes &a = packet.corner[0][axis], &b = packet.corner[1][axis],
                &c = packet.corner[2][axis];
    box.lower[static_cast<int>(axis)] = a.min(b).min(c).minCoeff() - margin;
    box.upper[static_cast<int>(axis)] = a.max(b).max(c).maxCoeff() + margin;
  }
  return box;
}

Box box_of(const TreeNode& node) {
  Box box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.lower[static_cast<int>(axis)] = node.sides[axis][0].minCoeff();
    box.upper[static_cast<int>(axis)] = node.sides[axis][1].maxCoeff();
  }
  return box;
}

float half_area(const Eigen::Array3f& size) {
  return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
}

}  // namespace

void refit(BoundingTree& tree, const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
           double margin) {
  parallel_for(tree.packets.size(),
               [&](std::size_t i) { set_corners(tree.packets[i], vertices, triangles); });
  const auto float_margin = static_cast<float>(margin);
  for (auto node = tree.nodes.rbegin(); node != tree.nodes.rend(); ++node) {
    for (auto& [lower, upper] : node->sides) {
      lower.setConstant(std::numeric_limits<float>::infinity());
      upper.setConstant(-std::numeric_limits<float>::infinity());
    }
    for (int lane = 0; lane < std::popcount(node->children); ++lane) {
      const int child = node->child[static_cast<std::size_t>(lane)];
      const Box box = child < 0
                          ? box_of(tree.packets[static_cast<std::size_t>(~child)], float_margin)
                          : box_of(tree.nodes[static_cast<std::size_t>(child)]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        node->sides[axis][0][lane] = box.lower[static_cast<int>(axis)];
        node->sides[axis][1][lane] = box.upper[static_cast<int>(axis)];
      }
    }
  }
}

double walking_cost(const BoundingTree& tree) {
  double sum = 0;
  for (const TreeNode& node : tree.nodes) {
    for (int lane = 0; lane < std::popcount(node.children); ++lane) {
      const auto size = [&](std::size_t axis) {
        return node.sides[axis][1][lane] - node.sides[axis][0][lane];
      };
      sum += static_cast<double>(half_area({size(0), size(1), size(2)}));
    }
  }
  const Box root = box_of(tree.nodes.front());
  return sum / static_cast<double>(half_area(root.upper - root.lower));
}

}  // namespace palpate::geometry
