// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/farthest_points.h"

#include <algorithm>
#include <optional>
#include <string>

#include "geodesic/geodesic_methods.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::geometry {
namespace {

int nearest_to_mean(const TriangleMesh& mesh, std::span<const int> candidates) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const int v : candidates)
    mean += mesh.vertices.col(v) / static_cast<double>(candidates.size());
  return *std::min_element(candidates.begin(), candidates.end(), [&](int a, int b) {
    return (mesh.vertices.col(a) - mean).squaredNorm() <
           (mesh.vertices.col(b) - mean).squaredNorm();
  });
}

// The candidates in ascending order, without those that no triangle has.
std::vector<int> usable(const TriangleMesh& mesh, std::span<const int> candidates,
                        std::span<const SurfacePoint> places) {
  std::vector<int> result;
  for (const int v : candidates) {
    if (v < 0 || v >= mesh.vertices.cols()) {
      throw InvalidInput("farthest_points: candidate " + std::to_string(v) +
                         " is not a vertex; it must be in [0, " +
                         std::to_string(mesh.vertices.cols()) + ")");
    }
    if (places[static_cast<size_t>(v)].triangle >= 0) result.push_back(v);
  }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace

FarthestPoints farthest_points(const TriangleMesh& mesh, std::span<const int> candidates,
                               const FarthestPointOptions& options) {
  require("FarthestPointOptions::spacing", options.spacing, above(0).finite(), "mm");
  require("FarthestPointOptions::count", options.count, above(0));
  check_mesh(mesh, "farthest_points");
  const std::vector<SurfacePoint> places = vertex_points(mesh);
  std::vector<int> left = usable(mesh, candidates, places);
  FarthestPoints found;
  if (left.empty()) return found;
  int next = nearest_to_mean(mesh, left);
  grow_distances(mesh, [&](const Eigen::VectorXd& distance) -> std::optional<SurfacePoint> {
    if (!found.vertices.empty()) {
      // By rounding, the distance at a source may be above a very small spacing.
      std::erase(left, next);
      if (left.empty()) {
        found.cover.push_back(0);
        return std::nullopt;
      }
      next = *std::max_element(left.begin(), left.end(),
                               [&](int a, int b) { return distance[a] < distance[b]; });
      found.cover.push_back(distance[next]);
      if (distance[next] < options.spacing) return std::nullopt;
      if (static_cast<int>(found.vertices.size()) >= options.count) return std::nullopt;
    }
    found.vertices.push_back(next);
    return places[static_cast<size_t>(next)];
  });
  return found;
}

}  // namespace palpate::geometry
