// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "query/quick_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "palpate/core/parallel_for.h"
#include "query/morton_curve.h"

namespace palpate::geometry {
namespace {

/// A triangle by its centre, three times as far from the origin.
struct Centre {
  Eigen::Array3f place;
  int triangle;
};

/// As many triangles as a node with full packets has.
constexpr std::size_t kBunch = std::size_t{TrianglePacket::kSize} * TreeNode::kSize;

/// Brings as many centres as are wanted, those lowest on an axis, to the front; otherwise they keep
/// their order. Precondition: at most kBunch.
void put_lowest_first(Centre* begin, const Centre* end, Eigen::Index axis, std::ptrdiff_t wanted) {
  const auto size = static_cast<std::size_t>(end - begin);
  std::array<Centre, kBunch> all;
  std::array<float, kBunch> place;
  for (std::size_t i = 0; i < size; ++i) {
    all[i] = begin[i];
    place[i] = begin[i].place[axis];
  }
  Centre* front = begin;
  Centre* back = begin + wanted;
  for (std::size_t i = 0; i < size; ++i) {
    // Counting is faster than partitioning for so few, because no branch has to be predicted.
    int lower = 0;
    for (std::size_t j = 0; j < size; ++j)
      lower += static_cast<int>(place[j] < place[i]) |
               (static_cast<int>(place[j] == place[i]) & static_cast<int>(j < i));
    *(lower < wanted ? front : back)++ = all[i];
  }
}

class QuickTree {
 public:
  QuickTree(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles) {
    centres_.resize(static_cast<std::size_t>(triangles.cols()));
    std::vector<OnMortonCurve> curve(centres_.size());
    parallel_for(centres_.size(), [&](std::size_t i) {
      const auto corners = triangles.col(static_cast<Eigen::Index>(i));
      const Eigen::Array3f place =
          (vertices.col(corners[0]) + vertices.col(corners[1]) + vertices.col(corners[2]))
              .cast<float>()
              .array();
      // The local frame is [-1, 1].
      const Eigen::Array3f cell = (place / 3 + 1) * (kMortonCells / 2.0F);
      const int triangle = static_cast<int>(i);
      centres_[i] = {.place = place, .triangle = triangle};
      curve[i] = {
          .place = morton_place(cell.max(0.0F).min(kMortonCells - 1.0F).cast<std::uint32_t>()),
          .index = triangle};
    });
    curve_ = sorted(std::move(curve));
  }

  BoundingTree build() {
    tree_.nodes.reserve(curve_.size() / kBunch * 2 + 1);
    tree_.packets.reserve(curve_.size() / 3 + 1);
    add_node({0, curve_.size()});
    return std::move(tree_);
  }

 private:
  static constexpr std::size_t kLeaf = TrianglePacket::kSize;

  /// A part of the curve.
  struct Part {
    std::size_t begin, end;
    [[nodiscard]] std::size_t size() const { return end - begin; }
  };

  /// The index at which the cube of a part is halved: where the highest bit that differs changes.
  [[nodiscard]] std::size_t middle(const Part& part) const {
    const auto place = [&](std::size_t i) { return curve_[i].place; };
    const std::uint64_t differing = place(part.begin) ^ place(part.end - 1);
    if (differing == 0) return part.begin + part.size() / 2;
    const std::uint64_t bit = std::bit_floor(differing);
    const auto first = curve_.begin();
    return static_cast<std::size_t>(
        std::partition_point(first + static_cast<std::ptrdiff_t>(part.begin),
                             first + static_cast<std::ptrdiff_t>(part.end),
                             [bit](const OnMortonCurve& one) { return (one.place & bit) == 0; }) -
        first);
  }

  int add(const Part& part) {
    if (part.size() > kLeaf) return add_node(part);
    std::array<Centre, kLeaf> leaf;
    return add_packet(leaf.data(), copy(part, leaf.data()));
  }

  int add_node(const Part& whole) {
    if (whole.size() <= kBunch) return add_bunch(whole);
    const std::size_t node = tree_.nodes.size();
    tree_.nodes.emplace_back();
    std::array<Part, TreeNode::kSize> parts = {whole};
    std::size_t count = 1;
    while (count < parts.size()) {
      const auto largest =
          std::max_element(parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(count),
                           [](const Part& a, const Part& b) { return a.size() < b.size(); });
      if (largest->size() <= kBunch) break;
      const std::size_t at = middle(*largest);
      parts[count++] = {at, largest->end};
      largest->end = at;
    }
    for (std::size_t lane = 0; lane < count; ++lane) set_child(node, lane, add(parts[lane]));
    return static_cast<int>(node);
  }

  /// A node of packets: halves at the median of the widest side.
  int add_bunch(const Part& part) {
    const std::size_t node = tree_.nodes.size();
    tree_.nodes.emplace_back();
    std::array<Centre, kBunch> bunch;
    std::size_t lane = 0;
    add_halves(node, lane, bunch.data(), copy(part, bunch.data()));
    return static_cast<int>(node);
  }

  /// Copies the centres of a part, and returns their end.
  Centre* copy(const Part& part, Centre* to) const {
    for (std::size_t i = part.begin; i < part.end; ++i)
      *to++ = centres_[static_cast<std::size_t>(curve_[i].index)];
    return to;
  }

  int add_packet(const Centre* begin, const Centre* end) {
    TrianglePacket& packet = tree_.packets.emplace_back();
    packet.triangle = {-1, -1, -1, -1};
    std::transform(begin, end, packet.triangle.begin(),
                   [](const Centre& one) { return one.triangle; });
    return ~static_cast<int>(tree_.packets.size() - 1);
  }

  void add_halves(std::size_t node, std::size_t& lane, Centre* begin, Centre* end) {
    const auto size = static_cast<std::size_t>(end - begin);
    if (size <= kLeaf) {
      set_child(node, lane++, add_packet(begin, end));
      return;
    }
    Eigen::Array3f lower = begin->place, upper = begin->place;
    for (const Centre* one = begin + 1; one != end; ++one) {
      lower = lower.min(one->place);
      upper = upper.max(one->place);
    }
    Eigen::Index axis = 0;
    (upper - lower).maxCoeff(&axis);
    // Both halves have full packets, except the last one.
    const std::size_t packets = (size + kLeaf - 1) / kLeaf;
    Centre* const half = begin + (packets + 1) / 2 * kLeaf;
    put_lowest_first(begin, end, axis, half - begin);
    add_halves(node, lane, begin, half);
    add_halves(node, lane, half, end);
  }

  void set_child(std::size_t node, std::size_t lane, int child) {
    tree_.nodes[node].child[lane] = child;
    tree_.nodes[node].children |= 1U << lane;
  }

  std::vector<Centre> centres_;
  std::vector<OnMortonCurve> curve_;  ///< the triangles
  BoundingTree tree_;
};

}  // namespace

BoundingTree build_quick_tree(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
                              double margin) {
  BoundingTree tree = QuickTree(vertices, triangles).build();
  refit(tree, vertices, triangles, margin);
  return tree;
}

}  // namespace palpate::geometry
