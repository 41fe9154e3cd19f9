// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"
#include "scans/distance_volume.h"

namespace palpate::geometry {

struct VolumeSurface {
  TriangleMesh mesh;          ///< faces the positive side; may have pinched vertices or full edges
  Eigen::VectorXd beyond;     ///< [mm] V, how far the vertices are beyond the borders of scans
  Eigen::VectorXd precision;  ///< [mm^-2] V
};

/// Finds the surface where the distances are zero, by dual contouring: a vertex for each piece of
/// the surface in a cell of eight known grid points, moved onto the zero of the trilinear
/// interpolation, and a quadrilateral for each edge of the grid that crosses the surface. The
/// surface ends where a grid point is unknown.
/// \param points sorted by key.
[[nodiscard]] VolumeSurface zero_surface(const Grid& grid, const std::vector<GridDistance>& points);

}  // namespace palpate::geometry
