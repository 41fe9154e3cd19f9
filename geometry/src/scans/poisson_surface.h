// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Closed surface through points with normals (3 x N each), with a resolution of `spacing` [mm].
/// \throws SolverError if there is none.
/// \throws Unavailable if the library was built without CGAL.
[[nodiscard]] TriangleMesh poisson_surface(const Eigen::Matrix3Xd& points,
                                           const Eigen::Matrix3Xd& normals, double spacing);

}  // namespace palpate::geometry
