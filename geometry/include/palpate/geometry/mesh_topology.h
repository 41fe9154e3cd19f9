// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// The sides of all triangles: half-edge 3 t + k runs from corner k of triangle t to its corner
/// (k + 1) % 3. Returned is, 3 x T, the half-edge that runs the other way along the same edge; -1
/// at the border.
/// \throws InvalidInput on a bad mesh, or naming the edge and the triangles if more than two
/// triangles share an edge, or two that are turned against each other.
[[nodiscard]] Eigen::Matrix3Xi opposite_half_edges(const TriangleMesh& mesh);

/// The border as cycles of vertices, each with the surface on its left (seen from outside): the
/// outline of a sheet runs counter-clockwise, a hole clockwise. A cycle starts at its smallest
/// vertex, the cycles are sorted by their first one. Where two parts touch in a single vertex, each
/// has its own. \throws InvalidInput as `opposite_half_edges`.
[[nodiscard]] std::vector<std::vector<int>> boundary_loops(const TriangleMesh& mesh);

/// Parts of a mesh that hang together by edges; a common vertex alone does not join.
struct ConnectedComponents {
  Eigen::VectorXi component;  ///< of each triangle, 0 .. count - 1 in the order of first triangles
  int count = 0;
};

/// \throws InvalidInput as `opposite_half_edges`.
[[nodiscard]] ConnectedComponents connected_components(const TriangleMesh& mesh);

/// Vertices (those of triangles only) minus edges plus triangles. Where no parts touch in a single
/// vertex, it is 2 components - 2 genus - boundary loops.
/// \throws InvalidInput as `opposite_half_edges`.
[[nodiscard]] int euler_characteristic(const TriangleMesh& mesh);

}  // namespace palpate::geometry
