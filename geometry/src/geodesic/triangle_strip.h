// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "geodesic/flat_triangles.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// The weights as they are used: none negative, and their sum is 1.
[[nodiscard]] Eigen::Vector3d clean_weights(const SurfacePoint& point);

/// All the ways to name a place, with clean weights: one in a triangle, two on an inner edge, and
/// one for each triangle at a vertex.
[[nodiscard]] std::vector<SurfacePoint> names_of(const FlatTriangles& flat,
                                                 const SurfacePoint& point);

/// The same place named in the triangle on the other side of a half-edge on which it lies.
[[nodiscard]] SurfacePoint named_across(const FlatTriangles& flat, int half_edge,
                                        const SurfacePoint& point);

/// The triangles through which a path runs, from a place in the first to one in the last of them.
struct TriangleStrip {
  SurfacePoint from;
  std::vector<int> crossed;  ///< half-edges, each of the triangle that the path leaves
  SurfacePoint to;
};

/// Adds a crossing, or takes the last one back if this is its reverse.
void cross_or_return(const FlatTriangles& flat, std::vector<int>& crossed, int half_edge);

/// Removes triangles at both ends of which the path needs only an edge or a vertex.
void trim(const FlatTriangles& flat, TriangleStrip& strip);

/// The strips of a path, which is cut where it passes a vertex between two fans of triangles.
/// \param points  at least two; neighbours are in one triangle
/// \throws InvalidInput naming the first that is in no triangle of the point before it.
[[nodiscard]] std::vector<TriangleStrip> strips_along(const FlatTriangles& flat,
                                                      std::span<const SurfacePoint> points);

}  // namespace palpate::geometry
