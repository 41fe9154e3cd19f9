// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// The closed surface through points with normals (3 x N each), as fine as their spacing [mm].
/// \throws SolverError if there is none, Unavailable if the library was built without CGAL.
[[nodiscard]] TriangleMesh poisson_surface(const Eigen::Matrix3Xd& points,
                                           const Eigen::Matrix3Xd& normals, double spacing);

}  // namespace palpate::geometry
