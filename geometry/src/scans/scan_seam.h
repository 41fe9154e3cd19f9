// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Which vertices of a surface in pieces a seam may join, and how; one entry a vertex.
struct Seam {
  std::vector<bool> may_join;   ///< of those at the border
  std::vector<bool> laid_bare;  ///< at the border only since something was cut off there
  std::vector<bool> piece;      ///< which side of the seam a vertex is on
  Eigen::Matrix3Xd normals;     ///< 3 x V, unit length or NaN; finite where `may_join`
  Eigen::VectorXd spacing;      ///< [mm] of points around the vertex; sets how wide the gap may be
  double step = 0;              ///< [mm] between the two pieces, at most
};

/// Triangles that close the gap between pieces of a surface, with no vertices of their own.
///
/// Greedy triangulation: edges between border vertices, the shortest first, each taken iff it runs
/// outside of the surface at both ends and crosses none before it, seen along the normals. The
/// faces of three edges are then the triangles; the order of edges around each vertex alone makes
/// them, so they are manifold and oriented with the surface whatever the shape. Faces of a few more
/// edges, where the surface is too rough for a common plane, are cut into triangles, corner by
/// corner.
/// Pre: the mesh is manifold and oriented (`opposite_half_edges` does not throw).
[[nodiscard]] Eigen::Matrix3Xi close_seam(const TriangleMesh& mesh, const Seam& seam);

}  // namespace palpate::geometry
