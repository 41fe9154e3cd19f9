// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "mesh/triangle_neighbours.h"

#include <cstddef>
#include <span>

#include "mesh/edge_table.h"

namespace palpate::geometry {

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

}  // namespace palpate::geometry
