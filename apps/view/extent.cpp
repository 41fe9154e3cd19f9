// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "extent.h"

#include <Eigen/Geometry>
#include <limits>

namespace palpate::view {

Extent extent_of(const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Extent extent;
  extent.low.setConstant(kInfinity);
  extent.high.setConstant(-kInfinity);
  for (const auto point : points.colwise()) {
    if (!point.allFinite()) continue;
    extent.low = extent.low.cwiseMin(point);
    extent.high = extent.high.cwiseMax(point);
  }
  if (!extent.low.allFinite()) extent.low = extent.high = Eigen::Vector3d::Zero();
  extent.center = (extent.low + extent.high) / 2;
  const double diagonal = (extent.high - extent.low).norm();
  if (diagonal > 0) extent.diagonal = diagonal;
  return extent;
}

Extent extent_of(const geometry::TriangleMesh& mesh) {
  Extent extent = extent_of(mesh.vertices(Eigen::all, mesh.triangles.reshaped()));
  double area = 0;
  for (const auto corners : mesh.triangles.colwise()) {
    const Eigen::Vector3d a = mesh.vertices.col(corners[0]);
    const Eigen::Vector3d normal =
        (mesh.vertices.col(corners[1]) - a).cross(mesh.vertices.col(corners[2]) - a);
    extent.facing += normal;
    area += normal.norm();
  }
  if (area > 0) extent.facing /= area;
  return extent;
}

}  // namespace palpate::view
