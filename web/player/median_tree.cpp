// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0

// Takes the place of Embree's tree in a page: halves at the median, of the widest side of centres.
#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

#include "query/bounding_tree.h"

namespace palpate::geometry {
namespace {

class MedianTree {
 public:
  MedianTree(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles)
      : centers_(Eigen::Matrix3Xd::Zero(3, triangles.cols())) {
    for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
      for (int k = 0; k < 3; ++k) centers_.col(t) += vertices.col(triangles(k, t));
    }
  }

  BoundingTree build() {
    std::vector<int> all(static_cast<std::size_t>(centers_.cols()));
    std::iota(all.begin(), all.end(), 0);
    tree_.nodes.reserve(all.size() / 2 + 1);
    add_node(all);
    return std::move(tree_);
  }

 private:
  using Part = std::span<int>;
  static constexpr std::size_t kLeaf = TrianglePacket::kSize;

  // Both halves have full packets, except the last one.
  [[nodiscard]] std::pair<Part, Part> halves(Part part) const {
    Eigen::Vector3d lower = centers_.col(part[0]), upper = lower;
    for (const int t : part) {
      lower = lower.cwiseMin(centers_.col(t));
      upper = upper.cwiseMax(centers_.col(t));
    }
    Eigen::Index axis = 0;
    (upper - lower).maxCoeff(&axis);
    const std::size_t packets = (part.size() + kLeaf - 1) / kLeaf;
    const std::size_t middle = std::min(part.size(), (packets + 1) / 2 * kLeaf);
    std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(middle), part.end(),
                     [&](int a, int b) {
                       return std::pair(centers_(axis, a), a) < std::pair(centers_(axis, b), b);
                     });
    return {part.first(middle), part.subspan(middle)};
  }

  int add(Part part) {
    if (part.size() > kLeaf) return add_node(part);
    TrianglePacket& packet = tree_.packets.emplace_back();
    packet.triangle = {-1, -1, -1, -1};
    std::copy(part.begin(), part.end(), packet.triangle.begin());
    return ~static_cast<int>(tree_.packets.size() - 1);
  }

  int add_node(Part part) {
    const std::size_t node = tree_.nodes.size();
    tree_.nodes.emplace_back();
    std::vector<Part> parts = {part};
    while (2 * parts.size() <= TreeNode::kSize) {
      std::vector<Part> halved;
      for (const Part one : parts) {
        if (one.size() <= kLeaf) {
          halved.push_back(one);
          continue;
        }
        const auto [left, right] = halves(one);
        halved.insert(halved.end(), {left, right});
      }
      if (halved.size() == parts.size()) break;
      parts = std::move(halved);
    }
    for (std::size_t lane = 0; lane < parts.size(); ++lane) {
      const int child = add(parts[lane]);
      tree_.nodes[node].child[lane] = child;
      tree_.nodes[node].children |= 1U << lane;
    }
    return static_cast<int>(node);
  }

  Eigen::Matrix3Xd centers_;  // three times as far from the origin
  BoundingTree tree_;
};

}  // namespace

BoundingTree build_tree(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
                        double margin, TreeBuild /*build*/) {
  BoundingTree tree = MedianTree(vertices, triangles).build();
  refit(tree, vertices, triangles, margin);
  return tree;
}

}  // namespace palpate::geometry
