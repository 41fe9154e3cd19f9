// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <functional>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// A mesh whose edges were split in the middle: a surface of the same shape with more vertices.
struct SplitMesh {
  TriangleMesh mesh;  ///< the vertices of the given mesh come first and are not moved
  /// 2 x M: each further vertex lies in the middle of these two, which come before it.
  Eigen::Matrix2Xi ends;
};

/// Splits edges at their middles until none is too long. Triangles keep their orientation; those
/// without a long edge come first, in their order.
/// \param is_long returns true if an edge between two points is too long; must return false for all
/// edges that are shorter than some length.
/// \throws InvalidInput if the mesh is not valid, or would have more vertices than an int counts.
[[nodiscard]] SplitMesh split_edges(
    const TriangleMesh& mesh,
    const std::function<bool(const Eigen::Vector3d&, const Eigen::Vector3d&)>& is_long);

/// Quantities of the vertices of a mesh, one column each, such as their positions at another time,
/// continued to the vertices of a split mesh. They are linear along the edges.
[[nodiscard]] Eigen::Matrix3Xd with_middles(const Eigen::Matrix3Xd& columns,
                                            const Eigen::Matrix2Xi& ends);

}  // namespace palpate::geometry
