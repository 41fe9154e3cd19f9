// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace palpate::view {

/// Solids of revolution about +z, of which arrow, ball, cone and rings are made.
enum class Shape {
  ball,  ///< of radius 1 about the origin
  rod,   ///< from z = 0 to 1, of radius 1, closed below
  tip,   ///< a cone from z = 0, where its radius is 1, to its tip at z = 1
  cone,  ///< from its tip at the origin to z = 1, where its radius is 1; open
  ring,  ///< of radius 1 about the origin; fine, for large ones
  halo   ///< the same; thick, for small ones
};
inline constexpr int kShapeCount = 6;

/// Triangles of a solid: three columns each.
struct ShapeCorners {
  Eigen::Matrix3Xf positions;  ///< 3 x N
  Eigen::Matrix3Xf normals;    ///< 3 x N, unit
};
[[nodiscard]] ShapeCorners corners_of(Shape shape);

}  // namespace palpate::view
