// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Stretch of a surface at each vertex, relative to a reference. All values are NaN at a vertex
/// whose neighbours do not determine them.
struct SurfaceStrain {
  Eigen::VectorXd largest, smallest;  ///< V; principal stretches: length / length in the reference
  Eigen::Matrix3Xd direction;  ///< 3 x V; unit vector of the largest stretch, on the moved surface;
                               ///< its sign means nothing
  Eigen::VectorXd area;        ///< V; area / area in the reference
};

/// Computes the stretch of a surface. At each vertex the linear map from the tangent plane of the
/// reference to that of the moved surface is fitted to the neighbours (least squares); the
/// stretches are its singular values. Neighbours are placed in the planes at their distances in
/// space, so that neither curvature nor bending counts as stretch, up to the square of the angle
/// between the normals of neighbours.
/// \param vertices [mm] 3 x V; the vertices of the reference after it has moved.
/// \param radius [mm] >= 0; neighbours are the vertices within this distance in the reference that
/// are connected with it there, and at least those that share an edge. A larger radius averages
/// noise.
/// \throws InvalidInput if the reference is not valid, `vertices` has another size or a vertex that
/// is not finite, or `radius` is not in its range.
[[nodiscard]] SurfaceStrain surface_strain(const TriangleMesh& reference,
                                           const Eigen::Matrix3Xd& vertices, double radius = 0);

}  // namespace palpate::geometry
