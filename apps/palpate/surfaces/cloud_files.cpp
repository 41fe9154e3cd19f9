// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "palpate/core/error.h"
#include "palpate/geometry/cloud_selection.h"
#include "palpate/geometry/range_map_cloud.h"
#include "palpate/sensing/camera_file.h"
#include "palpate/sensing/frame.h"
#include "shared/map_camera.h"
#include "shared/surface_colors.h"
#include "surfaces/cloud_steps.h"
#include "surfaces/describe_mesh.h"

namespace palpate::apps {
namespace {

/// Returns the points of a range map or depth image, with the data that `decode` wrote beside it.
geometry::PointCloud read_map(const fs::path& input, const CloudSettings& settings) {
  check_has_no_unit(input, settings.points, "point and mesh files");
  const geometry::RangeMap map = load_range_map(input, settings.camera);
  geometry::ImageF sigma;
  const fs::path beside = input.parent_path() / (input.stem().string() + "_sigma.tiff");
  if (is_range_map(input) && is_there(beside)) {
    sigma = geometry::read_depth_tiff(beside);
    if (sigma.rows() != map.z.rows() || sigma.cols() != map.z.cols())
      throw InvalidInput(
          fmt::format("{}: has {} x {} px, but its range map {} x {}. Decode this "
                      "frame again, or remove the file.",
                      beside.string(), sigma.cols(), sigma.rows(), map.z.cols(), map.z.rows()));
  }
  geometry::PointCloud cloud = geometry::organised_cloud(map, sigma);
  if (settings.color) {
    for (geometry::Attribute& color : colors_beside(input, cloud.points, settings.camera))
      geometry::set_attribute(cloud.attributes, std::move(color));
  }
  return cloud;
}

geometry::PointCloud read_one(const fs::path& input, const CloudSettings& settings) {
  if (is_folder(input))
    throw InvalidInput(input.string() +
                       ": is a folder; pass the files whose points form the cloud");
  if (is_range_map(input) || is_image(input)) return read_map(input, settings);
  if (settings.color)
    throw InvalidInput(input.string() +
                       ": --color works for range maps; point and mesh files keep "
                       "the colours that they have.");
  check_is_no_depth_call(input, settings.camera);
  return geometry::read_point_cloud(input, settings.points);
}

/// [px] Cameras whose pixels differ by less are the same: text formats round their numbers.
constexpr double kSamePixels = 0.01;

bool is_same(const geometry::Camera& a, const geometry::Camera& b) {
  if (a.width != b.width || a.height != b.height) return false;
  const Eigen::Array2Xd apart = (geometry::pixel_rays(a) - geometry::pixel_rays(b)).array().abs();
  return apart.row(0).maxCoeff() * a.fx < kSamePixels &&
         apart.row(1).maxCoeff() * a.fy < kSamePixels;
}

/// Known pixels have the colours of the cloud, others are black.
cv::Mat color_image(const geometry::PointCloud& cloud, const Eigen::Matrix4Xd& colors) {
  cv::Mat picture =
      cv::Mat::zeros(static_cast<int>(cloud.height), static_cast<int>(cloud.width), CV_8UC3);
  for (Eigen::Index i = 0; i < colors.cols(); ++i) {
    auto& pixel =
        picture.at<cv::Vec3b>(static_cast<int>(i / cloud.width), static_cast<int>(i % cloud.width));
    for (int k = 0; k < 3; ++k) {
      const double value = 255 * colors(2 - k, i);  // blue first
      if (value >= 0) pixel[k] = static_cast<unsigned char>(std::lround(value));
    }
  }
  return picture;
}

}  // namespace

WorkedCloud load_cloud(const std::vector<fs::path>& inputs, CloudSettings& settings) {
  std::vector<geometry::PointCloud> clouds;
  for (const fs::path& input : inputs) {
    clouds.push_back(read_one(input, settings));
    check_coordinates(input, clouds.back());
    if (known_count(clouds.back()) == 0)
      throw InvalidInput(input.string() + ": none of its " +
                         std::to_string(clouds.back().points.cols()) + " points is known");
  }
  const bool all_maps = std::all_of(inputs.begin(), inputs.end(), [](const fs::path& input) {
    return is_range_map(input) || is_image(input);
  });
  // The camera is at the origin of its frame.
  if (all_maps && !settings.viewpoint) settings.viewpoint = Eigen::Vector3d::Zero();
  WorkedCloud worked{.cloud = geometry::joined(clouds)};
  worked.prose = fmt::format("{} points read\n", known_count(worked.cloud));
  return worked;
}

std::string write_as_range_map(const fs::path& path, const geometry::PointCloud& cloud,
                               const std::optional<geometry::Camera>& camera) {
  if (cloud.height < 2) {
    throw InvalidInput(fmt::format(
        "{}: only the points of one range map, or of one organised file, become a range "
        "map; these {} points have no rows and columns",
        path.string(), cloud.points.cols()));
  }
  const fs::path beside = path.parent_path() / "rig.yaml";
  std::optional<geometry::Camera> seen_by = camera;
  std::string words = fmt::format("the camera is in {}", beside.string());
  const bool has_camera = is_there(beside);
  if (has_camera) {
    const geometry::Camera of_folder = sensing::read_camera(beside);
    if (seen_by && !is_same(*seen_by, of_folder)) {
      throw InvalidInput(fmt::format(
          "{}: is of another camera than the points; write the range map into another folder",
          beside.string()));
    }
    seen_by = of_folder;
  }
  geometry::RangeMap map;
  try {
    if (!seen_by) {
      seen_by = geometry::fitted_camera(cloud);
      words = fmt::format(
          "the camera that fits the points, fx {:.2f}, fy {:.2f}, cx {:.2f}, cy {:.2f} px without "
          "lens distortion, is in {}",
          seen_by->fx, seen_by->fy, seen_by->cx, seen_by->cy, beside.string());
    }
    map = geometry::range_map_of(cloud, *seen_by);
  } catch (const InvalidInput& error) {
    throw InvalidInput(
        fmt::format("{}: cannot be made: {}{}", path.string(), error.what(),
                    camera || has_camera ? "" : ". If its lens distorts, pass --camera"));
  }
  tell_doubts(path.string(), sensing::range_map_doubts(map));
  geometry::write_depth_tiff(path, map.z);
  if (const auto colors = geometry::colors(cloud.attributes))
    sensing::write_png(color_beside(path), color_image(cloud, *colors));
  if (!has_camera) sensing::write_camera(beside, *seen_by);
  return words;
}

}  // namespace palpate::apps
