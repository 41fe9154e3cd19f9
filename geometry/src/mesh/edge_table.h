// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <vector>

namespace palpate::geometry {

/// A side of a triangle on an edge of a mesh that may be defective.
struct EdgeSide {
  int low = -1;         ///< the end with the lower vertex index
  int high = -1;        ///< the other end
  int half_edge = -1;   ///< 3 t + k: from corner k of triangle t to its corner (k + 1) % 3
  bool upwards = true;  ///< true if it runs from `low` to `high`

  [[nodiscard]] int triangle() const { return half_edge / 3; }
  /// The corners (3 t + k) at `low` and at `high`.
  [[nodiscard]] int low_corner() const { return upwards ? half_edge : next_corner(); }
  [[nodiscard]] int high_corner() const { return upwards ? next_corner() : half_edge; }

 private:
  [[nodiscard]] int next_corner() const { return half_edge - half_edge % 3 + (half_edge + 1) % 3; }
};

/// The sides of all triangles, or of those for which `use` holds, sorted by edge and within an edge
/// by half-edge. Precondition: these triangles refer to existing vertices.
[[nodiscard]] std::vector<EdgeSide> sort_sides(const Eigen::Matrix3Xi& triangles);
[[nodiscard]] std::vector<EdgeSide> sort_sides(const Eigen::Matrix3Xi& triangles,
                                               const std::vector<bool>& use);

/// Calls `visit(std::span<const EdgeSide>)` with the sides of each edge.
void for_each_edge(const std::vector<EdgeSide>& sides, auto&& visit) {
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::find_if(first, sides.end(), [&](const EdgeSide& s) {
      return s.low != first->low || s.high != first->high;
    });
    visit(std::span<const EdgeSide>(first, last));
    first = last;
  }
}

/// A neighbouring triangle across each edge, 3 x T; row k belongs to the edge from corner k to
/// corner (k + 1) % 3. -1 at the border. Unlike `opposite_half_edges` it accepts any mesh:
/// orientation is ignored, and where more than two triangles meet, each names the next one by
/// index, cyclically.
[[nodiscard]] Eigen::Matrix3Xi triangle_neighbours(const Eigen::Matrix3Xi& triangles);

/// Triangles in use that have the same three vertices as an earlier one, ascending.
[[nodiscard]] std::vector<int> repeated_triangles(const Eigen::Matrix3Xi& triangles,
                                                  const std::vector<bool>& use);

/// Equivalence classes of triangle corners (3 t + k), each named by its lowest corner.
class CornerClasses {
 public:
  explicit CornerClasses(Eigen::Index corner_count);
  /// Joins the corners of two sides of one edge at both of its ends.
  void join(const EdgeSide& a, const EdgeSide& b);
  [[nodiscard]] int find(int corner);

 private:
  void join(int a, int b);
  std::vector<int> parent_;
};

}  // namespace palpate::geometry
