// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_cloud.h"

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

std::string size_of(Eigen::Index width, Eigen::Index height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

/// A line through points (x, y), in the least squares of y.
struct LineFit {
  double count = 0, x = 0, y = 0, xx = 0, xy = 0;  // means, and sums of products about them

  void add(double at, double value) {
    ++count;
    const double from_mean = at - x;
    x += from_mean / count;
    y += (value - y) / count;
    xx += from_mean * (at - x);
    xy += from_mean * (value - y);
  }

  /// Slope, and value at 0. The slope is 0 or not finite unless there are two different values.
  [[nodiscard]] std::pair<double, double> line() const { return {xy / xx, y - xy / xx * x}; }
};

}  // namespace

PointCloud organised_cloud(const RangeMap& map, const ImageF& sigma) {
  PointCloud cloud;
  cloud.points = back_project(map);
  cloud.width = map.z.cols();
  cloud.height = map.z.rows();
  if (sigma.size() == 0) return cloud;
  if (sigma.rows() != map.z.rows() || sigma.cols() != map.z.cols())
    throw InvalidInput("organised_cloud: sigma is " + size_of(sigma.cols(), sigma.rows()) +
                       " px, but the range map is " + size_of(map.z.cols(), map.z.rows()) + " px");
  set_attribute(cloud.attributes,
                {.name = "sigma",
                 .values = std::vector<float>(sigma.data(), sigma.data() + sigma.size()),
                 .list_sizes = {}});
  return cloud;
}

RangeMap range_map_of(const PointCloud& cloud, const Camera& camera) {
  const Eigen::Matrix2Xd rays = pixel_rays(camera);
  if (cloud.width != camera.width || cloud.height != camera.height ||
      cloud.points.cols() != rays.cols())
    throw InvalidInput("the cloud is " + size_of(cloud.width, cloud.height) +
                       " points, but the camera is " + size_of(camera.width, camera.height) +
                       " px; an organised cloud has a point per pixel");
  constexpr double kHalfPixel = 0.5;
  RangeMap map{
      .z = ImageF::Constant(camera.height, camera.width, std::numeric_limits<float>::quiet_NaN()),
      .camera = camera};
  for (Eigen::Index i = 0; i < cloud.points.cols(); ++i) {
    const Eigen::Vector3d point = cloud.points.col(i);
    if (!point.allFinite() || !(point.z() > 0)) continue;
    const Eigen::Vector2d off = point.head<2>() / point.z() - rays.col(i);
    if (!(std::abs(off.x()) * camera.fx <= kHalfPixel &&
          std::abs(off.y()) * camera.fy <= kHalfPixel))
      throw InvalidInput("the point of column " + std::to_string(i % cloud.width) + ", row " +
                         std::to_string(i / cloud.width) +
                         " is not where this pixel of the camera sees it; is the cloud in the "
                         "camera's frame, in mm, and not undistorted?");
    map.z.data()[i] = static_cast<float>(point.z());
  }
  return map;
}

Camera fitted_camera(const PointCloud& cloud) {
  if (cloud.width < 2 || cloud.height < 2 || cloud.points.cols() != cloud.width * cloud.height)
    throw InvalidInput("the cloud is " + size_of(cloud.width, cloud.height) +
                       " points; an organised cloud has a point per pixel");
  LineFit across, down;  // of columns and rows
  for (Eigen::Index i = 0; i < cloud.points.cols(); ++i) {
    const Eigen::Vector3d point = cloud.points.col(i);
    if (!point.allFinite() || !(point.z() > 0)) continue;
    const Eigen::Index row = i / cloud.width, column = i % cloud.width;
    across.add(point.x() / point.z(), static_cast<double>(column));
    down.add(point.y() / point.z(), static_cast<double>(row));
  }
  const auto [fx, cx] = across.line();
  const auto [fy, cy] = down.line();
  if (!std::isfinite(fx) || !std::isfinite(fy) || fx == 0 || fy == 0)
    throw InvalidInput("fewer than two columns or rows have points in front of the camera");
  if (!(fx > 0) || !(fy > 0))
    throw InvalidInput(std::string("the cloud is mirrored: ") +
                       (fx > 0 ? "Y points to lower rows" : "X points to lower columns") +
                       "; X has to point right, Y down and Z away from the camera");
  return {.width = static_cast<int>(cloud.width),
          .height = static_cast<int>(cloud.height),
          .fx = fx,
          .fy = fy,
          .cx = cx,
          .cy = cy};
}

}  // namespace palpate::geometry
