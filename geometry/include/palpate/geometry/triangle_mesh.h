// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>  // users need its cross products and boxes, which Eigen/Core only declares
#include <span>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::geometry {

/// A triangle mesh: vertices and triangles.
struct TriangleMesh {
  Eigen::Matrix3Xd vertices;   ///< [mm] 3 x V
  Eigen::Matrix3Xi triangles;  ///< 3 x T vertex indices, counter-clockwise seen from outside
};

/// A point on a mesh: a triangle and barycentric coordinates in it.
struct SurfacePoint {
  int triangle = -1;
  Eigen::Vector3d barycentric =
      Eigen::Vector3d::Zero();  ///< >= 0, sums to 1; order of the triangle's vertices
};

/// Checks the requirements of all algorithms: at least one triangle, finite vertices, indices in
/// range, and three different vertices per triangle.
/// \throws InvalidInput naming `what`, the first bad vertex or triangle, and what is wrong with it.
void check_mesh(const TriangleMesh& mesh, const char* what);

/// Barycentric coordinates are accepted iff each is >= -kBarycentricTolerance and their sum differs
/// from 1 by at most kBarycentricTolerance. Values rounded to six decimals, as in text files, pass.
inline constexpr double kBarycentricTolerance = 2e-6;

/// Checks that a point is on the mesh: its triangle is in range and its barycentric coordinates are
/// accepted.
/// \throws InvalidInput naming `what` and what is wrong.
void check_surface_point(const TriangleMesh& mesh, const SurfacePoint& point, const char* what);

/// [mm] position of a surface point. Precondition: the point is on the mesh.
[[nodiscard]] Eigen::Vector3d position(const TriangleMesh& mesh, const SurfacePoint& point);

/// Returns the vertex at corner 0, 1 or 2 of a triangle as a place on the mesh.
[[nodiscard]] SurfacePoint corner_point(int triangle, int corner);

/// Returns each of the V vertices as a place on the mesh, in the first triangle that has it. The
/// triangle is -1 for a vertex without one.
[[nodiscard]] std::vector<SurfacePoint> vertex_points(const TriangleMesh& mesh);

/// Returns some of the vertices as places on the mesh, such as sources of distances and vertices
/// along edges as a path.
/// \throws InvalidInput if the mesh is not valid, or naming `what` and the first that is not one of
/// its vertices, or is in no triangle.
[[nodiscard]] std::vector<SurfacePoint> vertex_points(const TriangleMesh& mesh,
                                                      std::span<const int> vertices,
                                                      const char* what = "vertices");

/// Unit normals of the triangles, 3 x T; NaN for a triangle without area (the sine of the angle at
/// its first vertex is zero within rounding).
[[nodiscard]] Eigen::Matrix3Xd triangle_normals(const TriangleMesh& mesh);

/// Unit normals of the vertices, 3 x V: means of the triangle normals weighted by the angle at the
/// vertex; NaN if no triangle at the vertex has an area, or if the normals cancel.
[[nodiscard]] Eigen::Matrix3Xd vertex_normals(const TriangleMesh& mesh);

/// [mm] diagonal of the bounding box of the triangles, to which tolerances are relative, or 0.
[[nodiscard]] double bounding_diagonal(const TriangleMesh& mesh);

}  // namespace palpate::geometry
