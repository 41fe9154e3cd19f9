// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>

#include "palpate/geometry/triangle_mesh.h"
#include "scans/grid_blocks.h"

namespace palpate::geometry {

/// The triangle that is nearest to a place.
struct NearTriangle {
  int triangle = -1;  ///< -1 if none is within reach
  int corner = -1;    ///< its corner that is the nearest point; -1 if it is not known to be one
};

/// The nearest triangles of a mesh at the grid points of a block.
struct NearTriangles {
  std::int64_t block = 0;
  std::array<NearTriangle, kBlockPoints> nearest;
};

/// Finds the nearest triangles at the grid points within `reach` of a mesh: those around the
/// nearest vertex (of large triangles, the nearest of points spread over them) are compared. Where
/// a rough surface folds between its vertices another triangle may be slightly nearer. Points up to
/// an edge length beyond the reach may be among them.
/// \param opposite of half-edges, see `opposite_half_edges`.
/// \param reach [spacings]
[[nodiscard]] std::deque<NearTriangles> nearest_triangles(const TriangleMesh& mesh,
                                                          const Eigen::Matrix3Xi& opposite,
                                                          const Grid& grid, double reach);

}  // namespace palpate::geometry
