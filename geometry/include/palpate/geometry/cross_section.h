// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Points joined one after the other, 3 x N [mm].
using Polyline = Eigen::Matrix3Xd;

/// A plane in the frame of a mesh.
struct Plane {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< [mm] any of its points
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();  ///< of any length but 0
};

/// The lines in which a mesh meets a plane, each from its end with the smaller X on, the line that
/// starts furthest left first; Y stands for X if the normal runs along X more than along Y and Z. A
/// closed line returns to its first point. Vertices exactly on the plane count as above it, so that
/// every line is whole.
/// \throws InvalidInput if the mesh is not valid, or the plane is not finite or has no normal.
[[nodiscard]] std::vector<Polyline> cross_section(const TriangleMesh& mesh, const Plane& plane);

/// The same for the plane Y = `y` [mm].
[[nodiscard]] std::vector<Polyline> cross_section(const TriangleMesh& mesh, double y);

}  // namespace palpate::geometry
