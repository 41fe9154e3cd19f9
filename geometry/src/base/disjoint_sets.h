// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace palpate::geometry {

/// Disjoint sets of 0 ... n - 1 whose members each have a sign relative to the root, their lowest
/// member (union-find; Tarjan 1975).
class SignedSets {
 public:
  explicit SignedSets(int count)
      : parent_(static_cast<std::size_t>(count)), turned_(static_cast<std::size_t>(count), 0) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  struct Root {
    int root;
    bool turned;  ///< true if the sign differs from the root's
  };
  Root root_of(int member) {
    int root = member;
    bool turned = false;
    while (parent(root) != root) {
      turned = turned != is_turned(root);
      root = parent(root);
    }
    // Path compression: all members on the way then point to the root.
    for (bool left = turned; parent(member) != root && member != root;) {
      const int next = parent(member);
      const bool step = is_turned(member);
      parent_[static_cast<std::size_t>(member)] = root;
      turned_[static_cast<std::size_t>(member)] = left ? 1 : 0;
      left = left != step;
      member = next;
    }
    return {root, turned};
  }

  /// Joins the sets of two members; `turned`: their signs then differ. Has no effect if they are in
  /// the same set.
  void join(int a, int b, bool turned = false) {
    Root low = root_of(a), high = root_of(b);
    if (low.root == high.root) return;
    if (low.root > high.root) std::swap(low, high);
    parent_[static_cast<std::size_t>(high.root)] = low.root;
    turned_[static_cast<std::size_t>(high.root)] = turned != (low.turned != high.turned) ? 1 : 0;
  }

 private:
  [[nodiscard]] int parent(int member) const { return parent_[static_cast<std::size_t>(member)]; }
  [[nodiscard]] bool is_turned(int member) const {
    return turned_[static_cast<std::size_t>(member)] != 0;
  }

  std::vector<int> parent_;
  std::vector<char> turned_;  ///< relative to the parent
};

}  // namespace palpate::geometry
