// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "mesh/edge_table.h"

#include <array>
#include <cstddef>
#include <numeric>
#include <utility>

namespace palpate::geometry {

namespace {

/// Sorts into buckets by the lower vertex first, which leaves few sides to sort in each.
std::vector<EdgeSide> sort_sides_of(const Eigen::Matrix3Xi& triangles, const auto& use) {
  const auto each_side = [&](const auto& visit) {
    for (int t = 0; t < triangles.cols(); ++t) {
      if (!use(t)) continue;
      for (int k = 0; k < 3; ++k) {
        const int from = triangles(k, t);
        const int to = triangles(k == 2 ? 0 : k + 1, t);
        visit(EdgeSide{std::min(from, to), std::max(from, to), 3 * t + k, from <= to});
      }
    }
  };
  int most = -1;
  each_side([&](const EdgeSide& side) { most = std::max(most, side.low); });
  std::vector<std::size_t> end(static_cast<std::size_t>(most) + 2, 0);
  each_side([&](const EdgeSide& side) { ++end[static_cast<std::size_t>(side.low) + 1]; });
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<EdgeSide> sides(end.back());
  // Filling a bucket moves its start to its end.
  each_side([&](const EdgeSide& side) { sides[end[static_cast<std::size_t>(side.low)]++] = side; });
  auto first = sides.begin();
  for (std::size_t v = 0; v + 1 < end.size(); ++v) {
    const auto last = sides.begin() + static_cast<std::ptrdiff_t>(end[v]);
    std::sort(first, last, [](const EdgeSide& a, const EdgeSide& b) {
      return a.high != b.high ? a.high < b.high : a.half_edge < b.half_edge;
    });
    first = last;
  }
  return sides;
}

}  // namespace

std::vector<EdgeSide> sort_sides(const Eigen::Matrix3Xi& triangles) {
  return sort_sides_of(triangles, [](int) { return true; });
}

std::vector<EdgeSide> sort_sides(const Eigen::Matrix3Xi& triangles, const std::vector<bool>& use) {
  return sort_sides_of(triangles, [&](int t) { return use[static_cast<std::size_t>(t)]; });
}

Eigen::Matrix3Xi triangle_neighbours(const Eigen::Matrix3Xi& triangles) {
  Eigen::Matrix3Xi neighbours = Eigen::Matrix3Xi::Constant(3, triangles.cols(), -1);
  for_each_edge(sort_sides(triangles), [&](std::span<const EdgeSide> sides) {
    for (std::size_t i = 0; sides.size() > 1 && i < sides.size(); ++i) {
      neighbours(sides[i].half_edge % 3, sides[i].triangle()) =
          sides[(i + 1) % sides.size()].triangle();
    }
  });
  return neighbours;
}

std::vector<int> repeated_triangles(const Eigen::Matrix3Xi& triangles,
                                    const std::vector<bool>& use) {
  std::vector<std::pair<std::array<int, 3>, int>> sorted;
  for (int t = 0; t < triangles.cols(); ++t) {
    if (!use[static_cast<size_t>(t)]) continue;
    std::array<int, 3> corners = {triangles(0, t), triangles(1, t), triangles(2, t)};
    std::sort(corners.begin(), corners.end());
    sorted.emplace_back(corners, t);
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<int> repeated;
  for (size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i].first == sorted[i - 1].first) repeated.push_back(sorted[i].second);
  }
  std::sort(repeated.begin(), repeated.end());
  return repeated;
}

CornerClasses::CornerClasses(Eigen::Index corner_count)
    : parent_(static_cast<size_t>(corner_count)) {
  std::iota(parent_.begin(), parent_.end(), 0);
}

int CornerClasses::find(int corner) {
  auto at = static_cast<size_t>(corner);
  while (parent_[at] != static_cast<int>(at)) {
    parent_[at] = parent_[static_cast<size_t>(parent_[at])];
    at = static_cast<size_t>(parent_[at]);
  }
  return static_cast<int>(at);
}

void CornerClasses::join(int a, int b) {
  const auto [low, high] = std::minmax({find(a), find(b)});
  parent_[static_cast<size_t>(high)] = low;
}

void CornerClasses::join(const EdgeSide& a, const EdgeSide& b) {
  join(a.low_corner(), b.low_corner());
  join(a.high_corner(), b.high_corner());
}

}  // namespace palpate::geometry
