// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/color_picture.h"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <system_error>

#include "palpate/core/error.h"
#include "palpate/sensing/frame.h"
#include "shared/surface_colors.h"

namespace palpate::apps {
namespace {

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
                        sensing::DepthRecordings& recordings) {
  const std::optional<sensing::RecordedDepth> frame = recordings.find(depth_image);
  if (!frame || frame->color.empty()) return {};
  std::error_code is_missing;
  for (const fs::path& place : {frame->recording, frame->color.parent_path()})
    if (fs::equivalent(folder, place, is_missing)) return frame->color;
  return {};
}

}  // namespace

fs::path picture_of(const fs::path& folder, const fs::path& range_map,
                    sensing::DepthRecordings& recordings) {
  if (!is_folder(folder)) throw FileError(folder.string() + ": is not a folder");
  const std::string name = range_map.stem().string();
  for (const char* ending : {"_color.png", ".png", ".jpg", ".tiff"}) {
    fs::path file = folder / (name + ending);
    if (is_there(file) && !fs::equivalent(file, range_map)) return file;
  }
  fs::path file = recorded_color(folder, range_map, recordings);
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
                               const Eigen::Matrix3Xd& vertices, const geometry::Camera& camera,
                               sensing::DepthRecordings& recordings) {
  const fs::path file = picture_of(folder, range_map, recordings);
  const cv::Mat picture = read_picture(file, camera);
  if (picture.depth() != CV_8U) throw FileError(file.string() + ": has 16 bit; 8 are expected");
  return colors_of(vertices, camera, picture);
}

geometry::ImageF intensities_in(const fs::path& folder, const fs::path& range_map,
                                const geometry::Camera& camera,
                                sensing::DepthRecordings& recordings) {
  cv::Mat picture;
  read_picture(picture_of(folder, range_map, recordings), camera).convertTo(picture, CV_32F);
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
