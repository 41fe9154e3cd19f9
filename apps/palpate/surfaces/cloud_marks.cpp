// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "palpate/core/error.h"
#include "shared/command_line.h"
#include "shared/progress.h"
#include "shared/words.h"
#include "surfaces/cloud_steps.h"

namespace palpate::apps {
namespace {

/// The numbers of the shapes of the points, 0 for none; all 0 if no shape was found yet.
std::vector<std::uint8_t> shapes_of(const geometry::PointCloud& cloud) {
  const geometry::Attribute* const shapes =
      geometry::find_attribute(cloud.attributes, kShapeAttribute);
  if (shapes == nullptr || !std::holds_alternative<std::vector<std::uint8_t>>(shapes->values))
    return std::vector<std::uint8_t>(static_cast<std::size_t>(cloud.points.cols()), 0);
  return std::get<std::vector<std::uint8_t>>(shapes->values);
}

/// Returns the points with those of a shape set to unknown, for the search for another shape.
Eigen::Matrix3Xd free_points(const geometry::PointCloud& cloud) {
  Eigen::Matrix3Xd points = cloud.points;
  const std::vector<std::uint8_t> shapes = shapes_of(cloud);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (shapes[static_cast<std::size_t>(i)] != 0)
      points.col(i).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return points;
}

void mark_shape(WorkedCloud& worked, const std::string& name,
                const geometry::PointsOnShape& on_shape, const Json& figures,
                const std::string& words) {
  std::vector<std::uint8_t> shapes = shapes_of(worked.cloud);
  const int number = shapes.empty() ? 1 : *std::max_element(shapes.begin(), shapes.end()) + 1;
  if (number > std::numeric_limits<std::uint8_t>::max())
    throw InvalidInput("--" + name + ": there are 255 shapes already; --remove some first");
  for (const int i : on_shape.inliers)
    shapes[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(number);
  geometry::set_attribute(worked.cloud.attributes,
                          {.name = kShapeAttribute, .values = std::move(shapes), .list_sizes = {}});
  worked.found = on_shape.inliers;
  worked.found_what = name;
  Json note = {{"shape", number}, {"on_it", on_shape.inliers.size()}, {"rms", on_shape.rms}};
  note.update(figures);
  note_step(worked, name, known_count(worked.cloud), note,
            fmt::format("{}; {} points are on it, {:.4g} mm RMS from it", words,
                        on_shape.inliers.size(), on_shape.rms));
}

SolverError not_found(const std::string& name, const geometry::CloudShapeOptions& options) {
  return SolverError(fmt::format(
      "--{}: no {} has {:g} % of the points within {:g} mm; a larger tolerance or a smaller "
      "--min-share may help",
      name, name, 100 * options.min_share, *options.tolerance));
}

geometry::CloudShapeOptions shape_options(const CloudSettings& settings) {
  geometry::CloudShapeOptions options = settings.shapes;
  options.progress = shown_as("looking for shapes");
  return options;
}

/// \throws InvalidInput if nothing was found since the points changed.
void check_found(const WorkedCloud& worked, const char* step) {
  if (!worked.found_what.empty()) return;
  throw InvalidInput(std::string("--") + step +
                     ": nothing is found before it; pass --plane, --sphere, --cylinder or "
                     "--cluster just before");
}

}  // namespace

void mark_plane(WorkedCloud& worked, const CloudSettings& settings) {
  geometry::CloudShapeOptions options = shape_options(settings);
  options.max_radius = geometry::CloudShapeOptions{}.max_radius;  // it is of the other shapes
  const auto plane = geometry::find_plane(free_points(worked.cloud), options);
  if (!plane) throw not_found("plane", options);
  mark_shape(worked, "plane", *plane,
             {{"point", numbers_in(plane->point)}, {"normal", numbers_in(plane->normal)}},
             fmt::format("normal ({:.4f}, {:.4f}, {:.4f}), through ({:.3f}, {:.3f}, {:.3f}) mm",
                         plane->normal.x(), plane->normal.y(), plane->normal.z(), plane->point.x(),
                         plane->point.y(), plane->point.z()));
}

void mark_sphere(WorkedCloud& worked, const CloudSettings& settings) {
  const auto sphere = geometry::find_sphere(free_points(worked.cloud), shape_options(settings));
  if (!sphere) throw not_found("sphere", settings.shapes);
  mark_shape(worked, "sphere", *sphere,
             {{"centre", numbers_in(sphere->centre)}, {"radius", sphere->radius}},
             fmt::format("radius {:.4f} mm, centre ({:.3f}, {:.3f}, {:.3f}) mm", sphere->radius,
                         sphere->centre.x(), sphere->centre.y(), sphere->centre.z()));
}

void mark_cylinder(WorkedCloud& worked, const CloudSettings& settings) {
  const Eigen::Matrix3Xd points = free_points(worked.cloud);
  std::optional<Eigen::Matrix3Xd> normals = geometry::normals(worked.cloud.attributes);
  if (!normals)
    normals = geometry::cloud_normals(points, {.progress = shown_as("finding normals")}).normals;
  const auto cylinder = geometry::find_cylinder(points, *normals, shape_options(settings));
  if (!cylinder) throw not_found("cylinder", settings.shapes);
  mark_shape(worked, "cylinder", *cylinder,
             {{"point", numbers_in(cylinder->point)},
              {"axis", numbers_in(cylinder->axis)},
              {"radius", cylinder->radius},
              {"length", cylinder->length}},
             fmt::format("radius {:.4f} mm, {:.2f} mm long, axis ({:.4f}, {:.4f}, {:.4f}) through "
                         "({:.3f}, {:.3f}, {:.3f}) mm",
                         cylinder->radius, cylinder->length, cylinder->axis.x(), cylinder->axis.y(),
                         cylinder->axis.z(), cylinder->point.x(), cylinder->point.y(),
                         cylinder->point.z()));
}

void mark_clusters(WorkedCloud& worked, const CloudSettings& settings) {
  geometry::CloudClusterOptions options = settings.clusters;
  options.progress = shown_as("joining points");
  const geometry::CloudClusters clusters = geometry::cloud_clusters(worked.cloud.points, options);
  if (clusters.sizes.empty())
    throw InvalidInput(
        fmt::format("--cluster: no cluster has {} points; lower --min-points or "
                    "raise the gap of {:g} mm",
                    options.min_points, *options.max_gap));
  geometry::set_attribute(
      worked.cloud.attributes,
      {.name = kClusterAttribute,
       .values = std::vector<std::int32_t>(clusters.cluster.begin(), clusters.cluster.end()),
       .list_sizes = {}});
  worked.found.clear();
  Eigen::Index inside = 0;
  for (std::size_t i = 0; i < clusters.cluster.size(); ++i) {
    if (clusters.cluster[i] == 0) worked.found.push_back(static_cast<int>(i));
    inside += clusters.cluster[i] >= 0 ? 1 : 0;
  }
  worked.found_what = "largest cluster";
  const Eigen::Index known = known_count(worked.cloud);
  note_step(worked, "cluster", known, {{"sizes", clusters.sizes}, {"in_none", known - inside}},
            fmt::format("{}, the largest of {} points; {} points are in none",
                        counted(clusters.sizes.size(), "cluster"), clusters.sizes.front(),
                        known - inside));
}

void keep_found(WorkedCloud& worked) {
  check_found(worked, "keep");
  const std::string what = worked.found_what;
  keep_only(worked, "keep", std::vector<int>(worked.found), "on the " + what);
}

void remove_found(WorkedCloud& worked) {
  check_found(worked, "remove");
  std::vector<bool> is_found(static_cast<std::size_t>(worked.cloud.points.cols()), false);
  for (const int i : worked.found) is_found[static_cast<std::size_t>(i)] = true;
  std::vector<int> others;
  for (int i = 0; i < worked.cloud.points.cols(); ++i) {
    if (!is_found[static_cast<std::size_t>(i)] && worked.cloud.points.col(i).allFinite())
      others.push_back(i);
  }
  const std::string what = worked.found_what;
  keep_only(worked, "remove", others, "not on the " + what);
}

}  // namespace palpate::apps
