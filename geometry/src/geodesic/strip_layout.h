// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geodesic/triangle_strip.h"

namespace palpate::geometry {

/// An edge that a path crosses, in the plane in which its strip is laid.
struct Portal {
  Eigen::Vector2d right, left;  ///< as seen along the path
  Eigen::Vector2d direction;    ///< unit, from right to left
  int right_vertex, left_vertex;

  [[nodiscard]] int vertex(bool is_left) const { return is_left ? left_vertex : right_vertex; }
  [[nodiscard]] const Eigen::Vector2d& end(bool is_left) const { return is_left ? left : right; }
};

/// A strip laid in the plane.
struct StripLayout {
  Eigen::Vector2d from, to;
  std::vector<Portal> portals;
};

[[nodiscard]] StripLayout lay_out(const FlatTriangles& flat, const TriangleStrip& strip);

/// A place where the shortest path in a strip bends: a vertex at the same side of some portals.
struct StripBend {
  Eigen::Vector2d at;
  bool is_left = false;
  int first = 0, last = -1;  ///< portals at the vertex
};

/// The bends of the shortest path, from the first to the last of them.
[[nodiscard]] std::vector<StripBend> funnel(const StripLayout& layout);

/// All portals next to each other that have the same vertex at one side.
[[nodiscard]] StripBend bend_at(const StripLayout& layout, int portal, bool is_left);

}  // namespace palpate::geometry
