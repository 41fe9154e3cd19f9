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

/// Curvature after Rusinkiewicz 2004: in each triangle the symmetric tensor S that best fits
/// n_j - n_i = S (x_j - x_i) on its three edges, with the vertex normals n; at a vertex the mean
/// over its triangles, turned into its tangent plane and weighted by their share of its Voronoi
/// area (Meyer et al. 2003, sec. 3.3). H is half the trace of S, K the product of its two
/// eigenvalues.
///
/// It sees two rings of triangles. Noise e on the vertices at spacing h becomes an error of the
/// order of e / h^2: measured surfaces are smoothed first (`smooth`). \throws InvalidInput as
/// `opposite_half_edges`.
[[nodiscard]] VertexCurvature vertex_curvature(const TriangleMesh& mesh);

}  // namespace palpate::geometry
