// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::view {

/// The bounding box of what is shown, and the direction that it faces.
struct Extent {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();     ///< [mm]
  Eigen::Vector3d high = Eigen::Vector3d::Zero();    ///< [mm]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< [mm]
  double diagonal = 1;                               ///< [mm] > 0
  /// Mean direction outwards: of length 1 for a plane, about 0 for an object that faces all around.
  Eigen::Vector3d facing = Eigen::Vector3d::Zero();
};

/// The extent of points [mm] 3 x N; columns that are not finite do not count. A single point, or
/// none, has a diagonal of 1.
[[nodiscard]] Extent extent_of(const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// The extent of a mesh. It faces the mean of the normals of its triangles, weighted by area.
[[nodiscard]] Extent extent_of(const geometry::TriangleMesh& mesh);

}  // namespace palpate::view
