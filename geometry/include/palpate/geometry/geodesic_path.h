// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "palpate/geometry/geodesic_surface.h"

namespace palpate::geometry {

/// A path on a surface: straight lines in the triangles from one point to the next.
struct GeodesicPath {
  /// At least the two ends. In between one on each edge that the path crosses and one at each
  /// vertex that it passes, with exact zeros for the corners that it is not between. The triangle
  /// of a point also has the point before it.
  std::vector<SurfacePoint> points;
  double length = 0;  ///< [mm]
  int source = 0;     ///< index of the source at which it begins
};

/// Finds the shortest path along the surface to each target from the source that is nearest to it.
///
/// The windows of `geodesic_distance` with GeodesicMethod::exact (Mitchell, Mount and Papadimitriou
/// 1987) are followed back from the target, which takes little time compared with making them, so
/// many targets cost little more than the farthest one. The path is then straightened as by
/// `straighten_path`, which removes rounding. Of equally short paths one is returned. The length is
/// that of the exact distance within 1e-9 of it and of the mean edge length.
/// \return for each target a path; none if no source is in the part of the surface that it is in.
/// \throws InvalidInput as `geodesic_distance` with GeodesicMethod::exact, or naming a target that
/// is not on the mesh.
/// \throws SolverError if triangles are so thin that a path is lost in rounding.
[[nodiscard]] std::vector<std::optional<GeodesicPath>> shortest_paths(
    const GeodesicSurface& surface, std::span<const SurfacePoint> sources,
    std::span<const SurfacePoint> targets);

/// Shortens a path between its ends until it is a geodesic: no shorter path is near it, and at each
/// vertex in between the angles of the surface on both sides of it are at least straight (on the
/// border the angle on the side of the surface).
///
/// The result can be deformed into the given path on the surface (it is in the same homotopy
/// class), so a path round a handle or a hole stays round it, and need not be the shortest of all.
/// It is found by flipping the path over the vertices at which it is not straight, as by the edge
/// flips of Sharp and Crane (2020), with the shortest path in the triangles that it passes in
/// between (Lee and Preparata 1984).
/// \param path  from one end to the other, >= 2 points; one triangle has each of them and the point
///   after it, such as the `vertex_points` of vertices along edges, or the points of
///   `GeodesicPath`s joined at their ends.
/// \throws InvalidInput as `shortest_paths`; if there are fewer than two points, or naming a point
/// that is in no triangle of the one before it.
[[nodiscard]] GeodesicPath straighten_path(const GeodesicSurface& surface,
                                           std::span<const SurfacePoint> path);

}  // namespace palpate::geometry
