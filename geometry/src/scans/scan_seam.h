// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// The vertices that a seam may join, and how; one entry per vertex of a surface in two pieces.
struct Seam {
  std::vector<bool> may_join;   ///< only vertices of the border
  std::vector<bool> laid_bare;  ///< on the border only because triangles were cut off there
  std::vector<bool> piece;      ///< side of the seam
  Eigen::Matrix3Xd normals;     ///< 3 x V, unit length or NaN; finite where `may_join`
  Eigen::VectorXd spacing;      ///< [mm] of points around the vertex; limits the width of the gap
  double step = 0;              ///< [mm] largest step between the two pieces
};

/// Makes triangles that close the gap between the pieces of a surface, without new vertices.
///
/// Greedy triangulation: edges between border vertices are added, shortest first, if they run
/// outside the surface at both ends and cross no earlier edge, seen along the normals. Faces with
/// three edges become triangles. Because they follow from the order of edges around each vertex
/// alone, they are manifold and oriented with the surface for any shape. Faces with a few more
/// edges, where the surface is too rough for a common plane, are triangulated corner by corner.
///
/// Precondition: the mesh is manifold and oriented (`opposite_half_edges` does not throw).
[[nodiscard]] Eigen::Matrix3Xi close_seam(const TriangleMesh& mesh, const Seam& seam);

}  // namespace palpate::geometry
