// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <limits>
#include <utility>

#include "query/bounding_tree.h"

// Code that the searches of a surface tree share.
namespace palpate::geometry {

/// Returns at least x >= 0, and little more; without the branches of std::nextafter.
inline float round_up(double x) {
  return static_cast<float>(x) * (1 + 2 * std::numeric_limits<float>::epsilon()) +
         std::numeric_limits<float>::min();
}

/// Ties go to the lower index.
inline bool improves(double candidate, int triangle, double best, int best_triangle) {
  return candidate < best || (candidate == best && best_triangle >= 0 && triangle < best_triangle);
}

/// Prefetches memory that will be read soon.
template <typename What>
void load(const What* first, std::size_t count = 1) {
  for (std::size_t byte = 0; byte < count * sizeof(What); byte += kCacheLine)
    __builtin_prefetch(reinterpret_cast<const char*>(first) + byte);
}

/// Children deferred by a traversal, with their distances.
template <typename Number>
class ChildStack {
 public:
  struct Entry {
    Number distance;
    int child;
  };
  [[nodiscard]] bool empty() const { return size_ == 0; }
  Entry pop() { return entries_[--size_]; }
  /// Defers all children of a node whose bits are set, except the nearest, which is returned, and
  /// begins to load them. Precondition: a bit is set.
  int defer_others(const BoundingTree& tree, const TreeNode& node,
                   const ChildLanes<Number>& distances, unsigned bits) {
    const auto first_entry = [&](unsigned set) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(set));
      return Entry{.distance = distances.data()[lane], .child = node.child[lane]};
    };
    Entry nearest = first_entry(bits);
    for (bits &= bits - 1; bits != 0; bits &= bits - 1) {
      Entry other = first_entry(bits);
      if (other.distance < nearest.distance) std::swap(nearest, other);
      if (other.child < 0) {
        load(&tree.packets[static_cast<std::size_t>(~other.child)]);
      } else {
        load(&tree.nodes[static_cast<std::size_t>(other.child)]);
      }
      entries_[size_++] = other;
    }
    return nearest.child;
  }

 private:
  // Not zero-initialised, because that would cost as much as a short traversal.
  std::array<Entry, std::size_t{TreeNode::kSize - 1} * BoundingTree::kMaxDepth> entries_;
  std::size_t size_ = 0;
};

/// Walks down the tree, to the nearest child first. Distances are of type `Number`.
/// \param meet finds the children of a node that matter, and their distances.
/// \param look_at looks at the packet with this number.
/// \param limit returns the distance beyond which nothing matters any more.
template <typename Number>
void walk_tree(const BoundingTree& tree, const auto& meet, const auto& look_at, const auto& limit) {
  ChildStack<Number> stack;
  int at = 0;  // the root
  while (true) {
    if (at < 0) {
      look_at(~at);
    } else {
      const TreeNode& node = tree.nodes[static_cast<std::size_t>(at)];
      ChildLanes<Number> distances;
      if (const unsigned bits = meet(node, distances); bits != 0) {
        at = stack.defer_others(tree, node, distances, bits);
        continue;
      }
    }
    typename ChildStack<Number>::Entry next{};
    do {
      if (stack.empty()) return;
      next = stack.pop();
    } while (next.distance > limit());
    at = next.child;
  }
}

}  // namespace palpate::geometry
