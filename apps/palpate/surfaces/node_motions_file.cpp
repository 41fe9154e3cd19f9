// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/node_motions_file.h"

#include <fmt/format.h>

#include <optional>
#include <string>

#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::apps {
namespace {

constexpr Eigen::Index kRows = 3, kCols = 4;

std::string entry_name(Eigen::Index row, Eigen::Index col) {
  return fmt::format("m{}{}", row, col);
}

}  // namespace

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
