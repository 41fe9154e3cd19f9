// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/surface_colors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "palpate/geometry/range_map_cloud.h"

namespace palpate::apps {
namespace {

using ByteColumn = std::vector<std::uint8_t>;

/// Red, green, blue of a pixel of a BGR or grey image.
std::uint8_t value_at(const cv::Mat& color, int row, int column, int rgb) {
  const int channel = color.channels() == 3 ? 2 - rgb : 0;
  return color.ptr(row)[column * color.channels() + channel];
}

geometry::Attributes attributes_of(ByteColumn red, ByteColumn green, ByteColumn blue) {
  return {
      {"red", std::move(red), {}}, {"green", std::move(green), {}}, {"blue", std::move(blue), {}}};
}

}  // namespace

geometry::Attributes colors_of(const Eigen::Matrix3Xd& vertices, const geometry::Camera& camera,
                               const cv::Mat& color) {
  ByteColumn rgb[3];
  for (Eigen::Index vertex = 0; vertex < vertices.cols(); ++vertex) {
    const Eigen::Vector2d pixel = geometry::distort(camera, vertices.col(vertex).hnormalized());
    // A vertex that smoothing or filling has moved out of view may have any pixel, or NaN.
    const auto inside = [](double value, int size) {
      return value > 0 ? static_cast<int>(std::lround(std::min<double>(value, size - 1))) : 0;
    };
    const int column = inside(pixel.x(), color.cols);
    const int row = inside(pixel.y(), color.rows);
    for (int i = 0; i < 3; ++i) rgb[i].push_back(value_at(color, row, column, i));
  }
  return attributes_of(std::move(rgb[0]), std::move(rgb[1]), std::move(rgb[2]));
}

geometry::PointCloud organised_cloud(const geometry::RangeMap& map, const cv::Mat& color) {
  geometry::PointCloud cloud = geometry::organised_cloud(map);
  if (color.empty()) return cloud;
  ByteColumn rgb[3];
  for (int row = 0; row < color.rows; ++row) {
    for (int column = 0; column < color.cols; ++column)
      for (int i = 0; i < 3; ++i) rgb[i].push_back(value_at(color, row, column, i));
  }
  cloud.attributes = attributes_of(std::move(rgb[0]), std::move(rgb[1]), std::move(rgb[2]));
  return cloud;
}

}  // namespace palpate::apps
