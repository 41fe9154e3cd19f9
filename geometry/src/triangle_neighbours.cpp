// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "triangle_neighbours.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace palpate::geometry {
namespace {

/// One side of a triangle, its edge as the pair of its vertices in ascending order.
struct Side {
  std::pair<int, int> edge;
  int half_edge;
};

}  // namespace

Eigen::Matrix3Xi triangle_neighbours(const Eigen::Matrix3Xi& triangles) {
  std::vector<Side> sides(static_cast<std::size_t>(triangles.size()));
  for (int h = 0; h < static_cast<int>(triangles.size()); ++h) {
    sides[static_cast<std::size_t>(h)] = {
        .edge = std::minmax(triangles(h % 3, h / 3), triangles((h + 1) % 3, h / 3)),
        .half_edge = h};
  }
  std::sort(sides.begin(), sides.end(), [](const Side& one, const Side& other) {
    return std::pair(one.edge, one.half_edge) < std::pair(other.edge, other.half_edge);
  });
  Eigen::Matrix3Xi neighbours = Eigen::Matrix3Xi::Constant(3, triangles.cols(), -1);
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last =
        std::find_if(first, sides.end(), [&](const Side& s) { return s.edge != first->edge; });
    for (auto side = first; last - first > 1 && side != last; ++side) {
      const auto next = side + 1 == last ? first : side + 1;
      neighbours(side->half_edge % 3, side->half_edge / 3) = next->half_edge / 3;
    }
    first = last;
  }
  return neighbours;
}

}  // namespace palpate::geometry
