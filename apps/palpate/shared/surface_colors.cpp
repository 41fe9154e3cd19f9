// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/surface_colors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/geometry/range_map_cloud.h"
#include "palpate/sensing/frame.h"

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

/// A picture of the camera's size.
cv::Mat read_picture(const fs::path& file, const geometry::Camera& camera) {
  cv::Mat picture = sensing::read_frame(file);
  if (picture.cols != camera.width || picture.rows != camera.height) {
    throw FileError(fmt::format(
        "{}: is {} x {} px; the size of the range map, {} x {} px, is expected: colour and depth "
        "images must be aligned, pixel by pixel",
        file.string(), picture.cols, picture.rows, camera.width, camera.height));
  }
  return picture;
}

/// The colour image that a recording has for a depth image, if `folder` is the recording or the
/// folder of its colour images; else empty.
fs::path recorded_color(const fs::path& folder, const fs::path& depth_image,
                        const MapCamera& camera) {
  const std::optional<sensing::RecordedDepth> frame = camera.files->recordings.find(depth_image);
  if (!frame || frame->color.empty()) return {};
  std::error_code is_missing;
  for (const fs::path& place : {frame->recording, frame->color.parent_path()})
    if (fs::equivalent(folder, place, is_missing)) return frame->color;
  return {};
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

fs::path picture_of(const fs::path& folder, const fs::path& range_map, const MapCamera& camera) {
  if (!is_folder(folder)) throw FileError(folder.string() + ": is not a folder");
  const std::string name = range_map.stem().string();
  for (const char* ending : {"_color.png", ".png", ".jpg", ".tiff"}) {
    fs::path file = folder / (name + ending);
    if (is_there(file) && !fs::equivalent(file, range_map)) return file;
  }
  fs::path file = recorded_color(folder, range_map, camera);
  if (!file.empty()) return file;
  throw FileError(fmt::format("{}: has no picture of {} ({}_color.png, {}.png, {}.jpg or {}.tiff)",
                              folder.string(), range_map.filename().string(), name, name, name,
                              name));
}

fs::path color_beside(const fs::path& range_map) {
  return range_map.parent_path() / (range_map.stem().string() + "_color.png");
}

geometry::Attributes colors_beside(const fs::path& range_map, const Eigen::Matrix3Xd& vertices,
                                   const MapCamera& camera) {
  const fs::path file = color_beside(range_map);
  if (!is_range_map(range_map) || !is_there(file)) {
    throw FileError(file.string() +
                    ": missing. --color needs the colour of the surface, which palpate decode "
                    "--surface-color writes beside the range map.");
  }
  const cv::Mat color = sensing::read_frame(file);
  const geometry::Camera seen_by = camera.files->cameras.read(rig_of(range_map, camera.rig)).camera;
  if (color.depth() != CV_8U || color.cols != seen_by.width || color.rows != seen_by.height) {
    throw FileError(
        fmt::format("{}: is {} x {} px of {} bit; 8 bit and the size of the range map, "
                    "{} x {} px, are expected",
                    file.string(), color.cols, color.rows, 8 * color.elemSize1(), seen_by.width,
                    seen_by.height));
  }
  return colors_of(vertices, seen_by, color);
}

geometry::Attributes colors_in(const fs::path& folder, const fs::path& range_map,
                               const Eigen::Matrix3Xd& vertices, const geometry::Camera& seen_by,
                               const MapCamera& camera) {
  const fs::path file = picture_of(folder, range_map, camera);
  const cv::Mat picture = read_picture(file, seen_by);
  if (picture.depth() != CV_8U) throw FileError(file.string() + ": has 16 bit; 8 are expected");
  return colors_of(vertices, seen_by, picture);
}

geometry::ImageF intensities_in(const fs::path& folder, const fs::path& range_map,
                                const geometry::Camera& seen_by, const MapCamera& camera) {
  cv::Mat picture;
  read_picture(picture_of(folder, range_map, camera), seen_by).convertTo(picture, CV_32F);
  const int channels = picture.channels();
  geometry::ImageF intensities = geometry::ImageF::Zero(picture.rows, picture.cols);
  for (int row = 0; row < picture.rows; ++row) {
    for (int column = 0; column < picture.cols; ++column) {
      const float* pixel = picture.ptr<float>(row) + channels * column;
      for (int i = 0; i < channels; ++i)
        intensities(row, column) += pixel[i] / static_cast<float>(channels);
    }
  }
  return intensities;
}

}  // namespace palpate::apps
