// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_undistortion.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/geometry/range_map_mesh.h"

namespace palpate::geometry {
namespace {

/// Pixels on the border of two triangles must not be lost by rounding.
constexpr double kOnBorder = 1e-9;

/// Draws a triangle whose corners are columns into an image of depths, where it is the nearest.
void draw_depths(const Camera& pinhole, const Eigen::Matrix3d& corners, ImageF& z) {
  const Eigen::Array3d u =
      pinhole.fx * (corners.row(0).array() / corners.row(2).array()) + pinhole.cx;
  const Eigen::Array3d v =
      pinhole.fy * (corners.row(1).array() / corners.row(2).array()) + pinhole.cy;
  const auto first = [](double low) {
    return static_cast<Eigen::Index>(std::max(0.0, std::ceil(low - kOnBorder)));
  };
  const auto last = [](double high, int size) {
    return static_cast<Eigen::Index>(std::min(size - 1.0, std::floor(high + kOnBorder)));
  };
  // A point of the triangle is corners * weights; its ray says what these are up to their sum.
  const Eigen::Matrix3d weights_of_ray = corners.inverse();
  for (Eigen::Index row = first(v.minCoeff()); row <= last(v.maxCoeff(), pinhole.height); ++row) {
    for (Eigen::Index col = first(u.minCoeff()); col <= last(u.maxCoeff(), pinhole.width); ++col) {
      const Eigen::Vector3d ray((static_cast<double>(col) - pinhole.cx) / pinhole.fx,
                                (static_cast<double>(row) - pinhole.cy) / pinhole.fy, 1);
      const Eigen::Vector3d weights = weights_of_ray * ray;
      const double sum = weights.sum();
      if (!(sum > 0) || weights.minCoeff() < -kOnBorder * sum) continue;
      const auto depth = static_cast<float>(1 / sum);
      float& pixel = z(row, col);
      if (!(pixel <= depth)) pixel = depth;
    }
  }
}

}  // namespace

RangeMap undistorted(const RangeMap& map) {
  const TriangleMesh surface = mesh_range_map(map).mesh;
  RangeMap result{
      .z = ImageF::Constant(map.z.rows(), map.z.cols(), std::numeric_limits<float>::quiet_NaN()),
      .camera = map.camera};
  result.camera.distortion = {};
  for (const auto& triangle : surface.triangles.colwise()) {
    Eigen::Matrix3d corners;
    for (Eigen::Index k = 0; k < 3; ++k) corners.col(k) = surface.vertices.col(triangle[k]);
    draw_depths(result.camera, corners, result.z);
  }
  return result;
}

}  // namespace palpate::geometry
