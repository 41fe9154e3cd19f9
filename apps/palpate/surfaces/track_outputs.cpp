// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/track_outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "palpate/core/error.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/pictures/draw_distances.h"
#include "shared/command_line.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

fs::path mesh_file(const TrackOutputs& outputs, const fs::path& range_map) {
  return outputs.folder / mesh_name(outputs, range_map);
}
fs::path picture_file(const TrackOutputs& outputs, const fs::path& range_map) {
  return outputs.folder / (range_map.stem().string() + ".png");
}

/// Draws the surface that was found in `range_map`, unless nothing of it was measured.
void draw(const TrackOutputs& outputs, const fs::path& range_map, const Eigen::Matrix3Xi& triangles,
          const geometry::TrackedSurface& found) {
  const geometry::DeformedSurface& surface = found.surface;
  const geometry::TriangleMesh mesh{.vertices = surface.vertices, .triangles = triangles};
  Eigen::VectorXd distances(mesh.triangles.cols());  // NaN unless all corners are measured
  for (Eigen::Index t = 0; t < distances.size(); ++t)
    distances[t] = surface.distance(mesh.triangles.col(t)).mean();
  const geometry::ErrorStatistics error =
      geometry::error_statistics({distances.begin(), distances.end()});
  if (error.count == 0) return;
  pictures::draw_distances(
      picture_file(outputs, range_map), mesh, distances,
      {.title =
           range_map.filename().string() + ": distance of the tracked surface from the range map",
       .subtitle =
           fmt::format("root mean square {:.3f} mm; grey was not measured", found.figures.rms),
       .limit = std::max(error.p95, kLeastScale)});
}

constexpr Eigen::Index kRows = 3, kCols = 4;

std::string entry_name(Eigen::Index row, Eigen::Index col) {
  return fmt::format("m{}{}", row, col);
}

/// Writes the nodes of a deformation graph at their moved positions, as points (.ply), each with
/// its motion: columns of the 3 x 4 matrix are the properties m00, m10, m20, m01, ..., m23.
/// Values that are read back have the same bits.
void write_node_motions(const fs::path& path, const geometry::DeformationGraph& graph,
                        const std::vector<Eigen::Isometry3d>& motions) {
  geometry::PointCloud cloud;
  cloud.points = graph.nodes();
  cloud.width = cloud.points.cols();
  for (Eigen::Index i = 0; i < cloud.width; ++i)
    cloud.points.col(i) = motions[static_cast<std::size_t>(i)] * cloud.points.col(i);
  for (Eigen::Index col = 0; col < kCols; ++col) {
    for (Eigen::Index row = 0; row < kRows; ++row) {
      std::vector<double> values;
      values.reserve(motions.size());
      for (const Eigen::Isometry3d& motion : motions) values.push_back(motion.matrix()(row, col));
      cloud.attributes.push_back(
          {.name = entry_name(row, col), .values = std::move(values), .list_sizes = {}});
    }
  }
  geometry::write_point_cloud(path, cloud);
}

}  // namespace

std::string mesh_name(const TrackOutputs& outputs, const fs::path& range_map) {
  return range_map.stem().string() + "." + outputs.format;
}

fs::path nodes_file(const TrackOutputs& outputs, const fs::path& range_map) {
  return outputs.folder / "nodes" / (range_map.stem().string() + ".ply");
}

bool has_outputs(const TrackOutputs& outputs, const TrackedFrame& frame) {
  const fs::path map = frame.range_map;
  return !frame.lost.empty() ||
         (is_there(mesh_file(outputs, map)) && is_there(nodes_file(outputs, map)) &&
          (!outputs.pictures || is_there(picture_file(outputs, map))));
}

void write_outputs(const TrackOutputs& outputs, const fs::path& range_map,
                   const geometry::Attributes& colors, const geometry::DeformationGraph& graph,
                   const geometry::TrackedSurface& found) {
  const Eigen::Matrix3Xi& triangles = graph.mesh().triangles;
  geometry::MeshFile mesh;
  mesh.vertex_attributes = colors;
  mesh.mesh = {.vertices = found.surface.vertices, .triangles = triangles};
  const auto add = [&](const char* name, const Eigen::VectorXd& values) {
    geometry::set_attribute(mesh.vertex_attributes,
                            {.name = name,
                             .values = std::vector<float>(values.begin(), values.end()),
                             .list_sizes = {}});
  };
  add("distance", found.surface.distance);
  add("sigma_across", found.surface.sigma_across);
  add("sigma_along", found.surface.sigma_along);
  if (outputs.pictures) draw(outputs, range_map, triangles, found);
  write_node_motions(nodes_file(outputs, range_map), graph, found.surface.node_motions);
  geometry::write_mesh_file(mesh_file(outputs, range_map), mesh);
}

std::vector<Eigen::Isometry3d> read_node_motions(const fs::path& path, Eigen::Index nodes) {
  const geometry::PointCloud cloud = geometry::read_point_cloud(path);
  if (cloud.points.cols() != nodes) {
    throw FileError(fmt::format("{}: holds the motions of {} nodes; expected those of {} nodes.",
                                path.string(), cloud.points.cols(), nodes));
  }
  std::vector<Eigen::Isometry3d> motions(static_cast<std::size_t>(nodes),
                                         Eigen::Isometry3d::Identity());
  for (Eigen::Index col = 0; col < kCols; ++col) {
    for (Eigen::Index row = 0; row < kRows; ++row) {
      const std::optional<Eigen::VectorXd> values =
          geometry::scalars(cloud.attributes, entry_name(row, col));
      if (!values || !values->allFinite()) {
        throw FileError(
            fmt::format("{}: property {} is missing or not finite; expected the motion "
                        "of each node as palpate track writes it.",
                        path.string(), entry_name(row, col)));
      }
      for (Eigen::Index i = 0; i < nodes; ++i)
        motions[static_cast<std::size_t>(i)].matrix()(row, col) = (*values)[i];
    }
  }
  return motions;
}

}  // namespace palpate::apps
