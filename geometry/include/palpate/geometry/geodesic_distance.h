// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct GeodesicOptions {
  double stop_radius = std::numeric_limits<double>::infinity();  ///< [mm] no vertex beyond it; > 0
};

struct GeodesicDistance {
  Eigen::VectorXd distance;  ///< [mm] V, to the nearest source along the surface; infinity = not reached
  Eigen::VectorXi label;     ///< V, index of the nearest source (its Voronoi cell); -1 = not reached
};

/// Distance along the surface to the nearest of several sources, by fast marching on the mesh (Kimmel
/// and Sethian 1998) with a virtual point source in each update, exact on planar patches, and
/// unfolding of obtuse triangles. The labels are the geodesic Voronoi cells of thesis 5.3.2.1.
/// \throws InvalidInput on a bad mesh, a source that is not on it, or stop_radius <= 0.
[[nodiscard]] GeodesicDistance geodesic_distance(const TriangleMesh& mesh, std::span<const SurfacePoint> sources,
                                                 const GeodesicOptions& options = {});

}  // namespace palpate::geometry
