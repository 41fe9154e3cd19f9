// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// [mm] bounding box of the triangles; empty without any. Vertices that no triangle uses do not
/// count. Precondition: the indices of vertices are in range.
[[nodiscard]] Eigen::AlignedBox3d bounding_box(const TriangleMesh& mesh);

/// [mm^2] sum of the areas of all triangles.
/// \throws InvalidInput if the mesh is not valid, or the area exceeds the largest number.
[[nodiscard]] double surface_area(const TriangleMesh& mesh);

/// [mm^3] volume enclosed by a closed surface, by the divergence theorem: the sum of the signed
/// tetrahedra a . (b x c) / 6 that the triangles span with a common point. Negative if the
/// triangles are counter-clockwise seen from inside. Several closed surfaces add up.
/// \throws InvalidInput if the mesh is not valid, as `opposite_half_edges`, or naming a border edge
/// if the mesh is open, or if the volume exceeds the largest number.
[[nodiscard]] double enclosed_volume(const TriangleMesh& mesh);

/// Lengths of the edges of a mesh, each counted once, and angles of its triangles.
struct MeshShape {
  Eigen::Index edges = 0;
  double shortest_edge = 0;  ///< [mm]
  double median_edge = 0;    ///< [mm] the lower one of two in the middle
  double mean_edge = 0;      ///< [mm]
  double longest_edge = 0;   ///< [mm]
  /// [rad] in [0, pi]; equilateral triangles have pi/3. An angle at a vertex that is in the place
  /// of another corner is 0.
  double smallest_angle = 0;
  double median_smallest_angle = 0;  ///< [rad] median of the smallest angle of each triangle
  double largest_angle = 0;          ///< [rad]
};

/// \throws InvalidInput if the mesh is not valid.
[[nodiscard]] MeshShape mesh_shape(const TriangleMesh& mesh);

}  // namespace palpate::geometry
