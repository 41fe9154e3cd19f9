// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "palpate/core/error.h"
#include "palpate/geometry/cloud_selection.h"
#include "palpate/geometry/range_map_cloud.h"
#include "shared/call_checks.h"
#include "shared/color_picture.h"
#include "surfaces/cloud_steps.h"
#include "surfaces/describe_cloud.h"

namespace palpate::apps {
namespace {

/// The points of a range map or depth image, with what `decode` has written beside it.
geometry::PointCloud read_map(const fs::path& input, const CloudSettings& settings) {
  if (settings.points.unit)
    throw InvalidInput(input.string() + ": --unit works for point and mesh files; " +
                       (is_range_map(input) ? "range maps are in mm"
                                            : "the unit of a depth image is its --scale"));
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
  if (settings.camera.scale || !settings.camera.intrinsics.empty()) {
    throw InvalidInput(input.string() + ": " +
                       (settings.camera.scale ? "--scale" : "--intrinsics") +
                       " works for depth images (16-bit PNG), which this is not");
  }
  return geometry::read_point_cloud(input, settings.points);
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

}  // namespace palpate::apps
