// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "edge_table.h"

#include <array>
#include <numeric>
#include <tuple>
#include <utility>

namespace palpate::geometry {

std::vector<EdgeSide> sort_sides(const Eigen::Matrix3Xi& triangles, const std::vector<bool>& use) {
  std::vector<EdgeSide> sides;
  sides.reserve(static_cast<size_t>(triangles.size()));
  for (int h = 0; h < triangles.size(); ++h) {
    if (!use[static_cast<size_t>(h / 3)]) continue;
    const auto [low, high] = std::minmax({triangles(h % 3, h / 3), triangles((h + 1) % 3, h / 3)});
    sides.push_back({low, high, h, triangles(h % 3, h / 3) == low});
  }
  std::sort(sides.begin(), sides.end(), [](const EdgeSide& a, const EdgeSide& b) {
    return std::tie(a.low, a.high, a.half_edge) < std::tie(b.low, b.high, b.half_edge);
  });
  return sides;
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
