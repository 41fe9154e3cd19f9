// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Curvature of a surface at each vertex. The principal curvatures are H +- sqrt(max(0, H^2 - K)).
///
/// NaN at the border, at a vertex without triangles, and next to a triangle without area.
struct VertexCurvature {
  Eigen::VectorXd mean;      ///< H [1/mm]; 1/r on a sphere, > 0 where the surface is convex
  Eigen::VectorXd gaussian;  ///< K [1/mm^2]; 1/r^2 on a sphere, < 0 on a saddle
};

/// Computes curvature after Rusinkiewicz 2004.
///
/// In each triangle the symmetric tensor S is fitted to n_j - n_i = S (x_j - x_i) on the three
/// edges, with the vertex normals n. The tensor at a vertex is the mean over its triangles, rotated
/// into its tangent plane and weighted by their share of its Voronoi area (Meyer et al. 2003, sec.
/// 3.3). H is half the trace of S, K the product of its eigenvalues.
///
/// The result depends on two rings of triangles. Noise e of the vertices at spacing h causes an
/// error of the order of e / h^2, so smooth measured surfaces first (`smooth`).
/// \throws InvalidInput as `opposite_half_edges`.
[[nodiscard]] VertexCurvature vertex_curvature(const TriangleMesh& mesh);

}  // namespace palpate::geometry
