// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Finds the opposite half-edges of all half-edges, 3 x T. Half-edge 3 t + k runs from corner k of
/// triangle t to its corner (k + 1) % 3; its opposite runs the other way along the same edge. -1 at
/// the border.
/// \throws InvalidInput if the mesh is not valid, or naming the edge and the triangles if more than
/// two triangles share an edge, or two of opposite orientation.
[[nodiscard]] Eigen::Matrix3Xi opposite_half_edges(const TriangleMesh& mesh);

/// Finds the border as cycles of vertices, each with the surface on its left (seen from outside):
/// the outline of a sheet runs counter-clockwise, a hole clockwise. A cycle starts at its smallest
/// vertex, and cycles are sorted by their first vertex. If two parts touch only in a vertex, each
/// has its own cycle.
/// \throws InvalidInput as `opposite_half_edges`.
[[nodiscard]] std::vector<std::vector<int>> boundary_loops(const TriangleMesh& mesh);

/// Parts of a mesh that are connected by edges; a common vertex alone does not connect.
struct ConnectedComponents {
  Eigen::VectorXi component;  ///< of each triangle, 0 .. count - 1 in order of first appearance
  int count = 0;
};

/// Finds the connected components.
/// \throws InvalidInput as `opposite_half_edges`.
[[nodiscard]] ConnectedComponents connected_components(const TriangleMesh& mesh);

/// Vertices (only those of triangles) minus edges plus triangles. If no parts touch only in a
/// vertex, this equals 2 components - 2 genus - boundary loops.
/// \throws InvalidInput as `opposite_half_edges`.
[[nodiscard]] int euler_characteristic(const TriangleMesh& mesh);

}  // namespace palpate::geometry
