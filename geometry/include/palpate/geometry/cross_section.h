// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Consecutive points of a line, 3 x N [mm].
using Polyline = Eigen::Matrix3Xd;

/// A plane in the frame of a mesh.
struct Plane {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< [mm] any point of the plane
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();  ///< any length except 0
};

/// Intersects a mesh with a plane.
///
/// The lines are sorted by the X of their start, and each starts at its end with the smaller X; Y
/// replaces X if the normal is closer to X than to Y and Z. A closed line returns to its first
/// point. Vertices exactly on the plane count as above it, so that no line is broken.
/// \throws InvalidInput if the mesh is not valid, or the plane is not finite or has no normal.
[[nodiscard]] std::vector<Polyline> cross_section(const TriangleMesh& mesh, const Plane& plane);

/// The same for the plane Y = `y` [mm].
[[nodiscard]] std::vector<Polyline> cross_section(const TriangleMesh& mesh, double y);

}  // namespace palpate::geometry
