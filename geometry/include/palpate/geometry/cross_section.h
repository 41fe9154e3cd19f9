// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Points joined one after the other, 3 x N [mm].
using Polyline = Eigen::Matrix3Xd;

/// The lines in which a mesh meets the plane Y = `y` [mm] of its own frame, each from its end with
/// the smaller X on, the line that starts furthest left first. A closed line returns to its first
/// point. Vertices exactly on the plane count as above it, so that every line is whole.
/// \throws InvalidInput if the mesh is not valid.
[[nodiscard]] std::vector<Polyline> cross_section(const TriangleMesh& mesh, double y);

}  // namespace palpate::geometry
