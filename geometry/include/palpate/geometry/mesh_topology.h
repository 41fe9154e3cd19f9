// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// The sides of all triangles: half-edge 3 t + k runs from corner k of triangle t to its corner
/// (k + 1) % 3. Returned is, 3 x T, the half-edge that runs the other way along the same edge; -1
/// at the border.
/// \throws InvalidInput on a bad mesh, or naming the edge and the triangles if more than two
/// triangles share an edge, or two that are turned against each other.
[[nodiscard]] Eigen::Matrix3Xi opposite_half_edges(const TriangleMesh& mesh);

}  // namespace palpate::geometry
