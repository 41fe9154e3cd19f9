// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace palpate::geometry {

/// Vertices and triangles: the surface everything else stands on.
struct TriangleMesh {
  Eigen::Matrix3Xd vertices;   ///< [mm] 3 x V
  Eigen::Matrix3Xi triangles;  ///< 3 x T vertex indices, counter-clockwise seen from outside
};

/// A place on a mesh: a triangle and barycentric coordinates in it.
struct SurfacePoint {
  int triangle = -1;
  Eigen::Vector3d barycentric =
      Eigen::Vector3d::Zero();  ///< >= 0, sums to 1; order of the triangle's vertices
};

/// Checks what every algorithm here relies on: at least one triangle, finite vertices, indices in
/// range, three different vertices a triangle.
/// \throws InvalidInput naming `what`, the first bad vertex or triangle, and what is wrong with it.
void check_mesh(const TriangleMesh& mesh, const char* what);

/// Barycentric coordinates are on their triangle iff each is >= -kBarycentricTolerance and their
/// sum differs from 1 by at most kBarycentricTolerance. Six decimals, as text files carry them,
/// pass.
inline constexpr double kBarycentricTolerance = 2e-6;

/// Checks that a point is on the mesh: triangle in range, barycentric coordinates of a point in it.
/// \throws InvalidInput naming `what` and what is wrong.
void check_surface_point(const TriangleMesh& mesh, const SurfacePoint& point, const char* what);

/// [mm] position of a point of the surface. Pre: the point is on the mesh.
[[nodiscard]] Eigen::Vector3d position(const TriangleMesh& mesh, const SurfacePoint& point);

/// Unit normals, 3 x T; NaN for a triangle without area (a sine of the angle at its first vertex
/// within rounding of zero).
[[nodiscard]] Eigen::Matrix3Xd triangle_normals(const TriangleMesh& mesh);

/// Unit normals, 3 x V, each the mean of its triangles' normals weighted by their angle at the
/// vertex; NaN for a vertex without a triangle that has an area, or when the normals cancel.
[[nodiscard]] Eigen::Matrix3Xd vertex_normals(const TriangleMesh& mesh);

/// [mm] length of the diagonal of the bounding box: the length that tolerances are relative to;
/// 0 without vertices.
[[nodiscard]] double bounding_diagonal(const TriangleMesh& mesh);

}  // namespace palpate::geometry
