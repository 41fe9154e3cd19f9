// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/cloud_steps.h"

#include <fmt/format.h>

#include "palpate/core/error.h"
#include "palpate/geometry/cloud_distance.h"
#include "palpate/geometry/cloud_sampling.h"
#include "palpate/geometry/cloud_selection.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/mesh_distance.h"
#include "palpate/geometry/range_map_mesh.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

/// Sets the attribute `distance`, and notes its statistics.
void note_distances(WorkedCloud& worked, const char* name, const fs::path& reference,
                    const Eigen::VectorXd& distances) {
  const geometry::ErrorStatistics errors =
      geometry::error_statistics({distances.begin(), distances.end()});
  geometry::set_attribute(worked.cloud.attributes,
                          {.name = "distance",
                           .values = std::vector<double>(distances.begin(), distances.end()),
                           .list_sizes = {}});
  note_step(worked, name, known_count(worked.cloud),
            {{"reference", reference.string()},
             {"rms", errors.rms},
             {"median", errors.median},
             {"p90", errors.p90},
             {"max", errors.max}},
            fmt::format("from {}: {:.4g} mm RMS, {:.4g} mm in the median, {:.4g} mm at most",
                        reference.string(), errors.rms, errors.median, errors.max));
}

geometry::TriangleMesh read_reference_mesh(const fs::path& path, const CloudSettings& settings) {
  if (is_range_map(path) || is_image(path))
    return geometry::mesh_range_map(load_range_map(path, settings.camera)).mesh;
  return geometry::read_mesh(path, settings.points);
}

}  // namespace

void crop(WorkedCloud& worked, const Eigen::AlignedBox3d& box) {
  keep_only(worked, "crop", geometry::points_in_box(worked.cloud.points, box), "inside the box");
}

void remove_outliers(WorkedCloud& worked, const CloudSettings& settings) {
  geometry::OutlierOptions options = settings.outliers;
  options.progress = shown_as("looking for outliers");
  keep_only(worked, "outliers", geometry::without_outliers(worked.cloud.points, options),
            fmt::format("at most {:g} standard deviations farther than usual from their neighbours",
                        options.max_deviations));
}

void remove_isolated(WorkedCloud& worked, double radius, int neighbours) {
  keep_only(worked, "isolated",
            geometry::without_isolated(worked.cloud.points, radius, neighbours,
                                       shown_as("looking for isolated points")),
            fmt::format("with {} others within {:g} mm", neighbours, radius));
}

void average_voxels(WorkedCloud& worked, double edge) {
  const Eigen::Index before = known_count(worked.cloud);
  // Numbers of shapes and clusters have no mean.
  std::erase_if(worked.cloud.attributes, [](const geometry::Attribute& attribute) {
    return attribute.name == kShapeAttribute || attribute.name == kClusterAttribute;
  });
  const geometry::VoxelSample sample = geometry::voxel_sample(worked.cloud.points, edge);
  worked.cloud = geometry::averaged(worked.cloud, sample.voxel, sample.points);
  worked.found_what.clear();
  note_step(worked, "voxel", before, Json::object(),
            fmt::format("means of the points in each voxel of {:g} mm", edge));
}

void sample_poisson(WorkedCloud& worked, double min_distance) {
  const Eigen::Index before = known_count(worked.cloud);
  const std::vector<int> chosen =
      geometry::poisson_sample(worked.cloud.points, min_distance, shown_as("sampling"));
  worked.cloud = geometry::selected(worked.cloud, chosen);
  worked.found_what.clear();
  note_step(worked, "poisson", before, Json::object(),
            fmt::format("no two closer than {:g} mm", min_distance));
}

void find_normals(WorkedCloud& worked, const CloudSettings& settings) {
  geometry::CloudNormalOptions options = settings.normals;
  options.progress = shown_as("finding normals");
  if (settings.viewpoint) options.viewpoints = *settings.viewpoint;
  const geometry::CloudNormals found = geometry::cloud_normals(worked.cloud.points, options);
  geometry::set_normals(worked.cloud.attributes, found.normals);
  const Eigen::Index known = known_count(worked.cloud);
  const Eigen::Index without = found.unknown - (worked.cloud.points.cols() - known);
  note_step(worked, "normals", known, {{"without_normal", without}},
            fmt::format("from {} neighbours, {}; {} points without", options.neighbours,
                        settings.viewpoint ? "towards the viewpoint" : "outwards", without));
}

void measure_from_mesh(WorkedCloud& worked, const fs::path& reference,
                       const CloudSettings& settings) {
  note_distances(worked, "from-mesh", reference,
                 geometry::distances_to_surface(worked.cloud.points,
                                                read_reference_mesh(reference, settings)));
}

void measure_from_cloud(WorkedCloud& worked, const fs::path& reference,
                        const CloudSettings& settings) {
  CloudSettings for_reference = settings;
  for_reference.color = false;
  const WorkedCloud other = load_cloud({reference}, for_reference);
  note_distances(worked, "from-cloud", reference,
                 geometry::distances_to_cloud(worked.cloud.points, other.cloud.points,
                                              shown_as("measuring distances")));
}

Eigen::Index known_count(const geometry::PointCloud& cloud) {
  Eigen::Index known = 0;
  for (const auto& point : cloud.points.colwise()) known += point.allFinite() ? 1 : 0;
  return known;
}

void note_step(WorkedCloud& worked, const std::string& name, Eigen::Index known_before,
               const Json& figures, const std::string& words) {
  const Eigen::Index known = known_count(worked.cloud);
  Json note = {{"step", name}, {"known", known}, {"removed", known_before - known}};
  note.update(figures);
  worked.steps.push_back(std::move(note));
  worked.prose += known == known_before ? fmt::format("{}: {}\n", name, words)
                                        : fmt::format("{}: {} of {} points left, {}\n", name, known,
                                                      known_before, words);
}

void keep_only(WorkedCloud& worked, const std::string& name, const std::vector<int>& kept,
               const std::string& words) {
  const Eigen::Index before = known_count(worked.cloud);
  if (kept.empty())
    throw InvalidInput(fmt::format("--{}: none of the {} points is {}, so nothing would be left",
                                   name, before, words));
  worked.cloud = worked.cloud.height > 1 ? geometry::with_only(worked.cloud, kept)
                                         : geometry::selected(worked.cloud, kept);
  worked.found_what.clear();
  note_step(worked, name, before, Json::object(), words);
}

}  // namespace palpate::apps
