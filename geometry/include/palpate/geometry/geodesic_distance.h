// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <span>

#include "palpate/geometry/geodesic_surface.h"

namespace palpate::geometry {

enum class GeodesicMethod {
  fast_marching,  ///< for any mesh; errors of some tenths of a percent
  exact           ///< for oriented surfaces; errors below 1e-10; some twenty times slower
};

struct GeodesicOptions {
  GeodesicMethod method = GeodesicMethod::fast_marching;
  double stop_radius = std::numeric_limits<double>::infinity();  ///< [mm] largest distance; > 0
  /// Called by `exact` in the calling thread now and then, with the number of vertices that were
  /// reached and of all; the last call has done == total. If it throws, the work ends.
  std::function<void(int done, int total)> progress = {};
};

struct GeodesicDistance {
  Eigen::VectorXd distance;  ///< [mm] V, to the nearest source; infinity if not reached
  Eigen::VectorXi label;  ///< V, index of the nearest source (its Voronoi cell); -1 if not reached
};

/// Computes the distance along the surface to the nearest of several sources.
///
/// `fast_marching` (Kimmel and Sethian 1998): in each triangle the wave is taken to come from a
/// point in its plane. This is exact on planar patches with triangles of any shape. A vertex is
/// corrected if a shorter path is found later, which replaces the unfolding of obtuse triangles.
/// Behind a corner of the border the wave continues in circles around the corner. Each source has
/// its own wave, which ends slightly outside its geodesic Voronoi cell (thesis 5.3.2.1), so that
/// labels are as accurate at cell borders as elsewhere; a tie within rounding goes to the lowest
/// source. Errors of `fast_marching`:
///
/// - On range maps of at least 3e4 triangles the mean error is below 0.25 % of the distance and the
///   largest 1.5 % (3 % within a few edges of a source).
/// - With needle triangles the mean error is 0.5 %. The distance is a few percent too short where a
///   wave meets itself behind a finger.
///
/// `exact`: shortest path over the triangles by propagation of windows (Mitchell, Mount and
/// Papadimitriou 1987, with the filter of Xin and Wang 2009), accurate to 1e-10 of the distance and
/// of the mean edge length. Rounding decides between equally near sources; of several in one place
/// the lowest wins. At most two triangles, of the same orientation, may share an edge, and all must
/// have an area.
/// \throws InvalidInput if there is no source, a source is not on the mesh, or stop_radius <= 0;
/// from `exact` also naming an edge with a third or turned triangle, or a triangle without area.
[[nodiscard]] GeodesicDistance geodesic_distance(const GeodesicSurface& surface,
                                                 std::span<const SurfacePoint> sources,
                                                 const GeodesicOptions& options = {});

/// Computes the distance along the surface to each of several sources, in several threads: the same
/// as `geodesic_distance` with each source alone.
/// \param options `progress` counts sources, and is called by one thread at a time.
/// \return [mm] V x N, a column for each source; infinity if not reached.
/// \throws InvalidInput as `geodesic_distance`.
[[nodiscard]] Eigen::MatrixXd geodesic_distances(const GeodesicSurface& surface,
                                                 std::span<const SurfacePoint> sources,
                                                 const GeodesicOptions& options = {});

}  // namespace palpate::geometry
