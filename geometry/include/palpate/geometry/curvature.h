// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// How a surface bends at each vertex. The principal curvatures are H +- sqrt(max(0, H^2 - K)).
///
/// NaN at the border, at a vertex without triangles, and at one with a triangle without area.
struct VertexCurvature {
  Eigen::VectorXd mean;      ///< H [1/mm]; > 0 where the surface bulges out, 1/r on a sphere
  Eigen::VectorXd gaussian;  ///< K [1/mm^2]; 1/r^2 on a sphere, < 0 on a saddle
};

/// Curvature after Meyer, Desbrun, Schroeder and Barr 2003: with the mixed Voronoi area A of vertex
/// i,
///
///     H = n_i . sum_j (cot a_ij + cot b_ij) (x_i - x_j) / (4 A),    K = (2 pi - sum of angles) / A
///
/// where n_i is the vertex normal, a_ij and b_ij are the angles opposite to the edge ij. It sees
/// one ring of triangles: noise e on the vertices becomes some 4 e / h^2 at spacing h, so measured
/// surfaces are smoothed first (`smooth`). \throws InvalidInput as `opposite_half_edges`.
[[nodiscard]] VertexCurvature vertex_curvature(const TriangleMesh& mesh);

}  // namespace palpate::geometry
