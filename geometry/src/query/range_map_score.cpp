// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "mesh/edge_table.h"
#include "palpate/error.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/parallel_for.h"
#include "palpate/require.h"

namespace palpate::geometry {
namespace {

/// Quantile of sorted values, interpolated linearly.
double quantile(const std::vector<double>& sorted, double fraction) {
  const double place = fraction * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double t = place - static_cast<double>(below);
  return (1 - t) * sorted[below] + t * sorted[above];
}

void check_same_size(const char* function, Eigen::Index rows, Eigen::Index cols,
                     const ImageF& reference) {
  if (rows == reference.rows() && cols == reference.cols()) return;
  throw InvalidInput(std::string(function) + ": the maps have different sizes, " +
                     std::to_string(cols) + " x " + std::to_string(rows) + " and " +
                     std::to_string(reference.cols()) + " x " + std::to_string(reference.rows()) +
                     " pixels. Compare maps of one camera.");
}

/// Outward direction. At an edge or a vertex the normal of a single triangle may give the wrong
/// sign; correct are the sum of both normals and the angle-weighted mean, respectively (Baerentzen
/// and Aanaes 2005).
struct Sides {
  Eigen::Matrix3Xd of_triangles;
  Eigen::Matrix3Xd of_vertices;
  Eigen::Matrix3Xi triangles;
  Eigen::Matrix3Xi neighbours;

  explicit Sides(const TriangleMesh& mesh)
      : of_triangles(triangle_normals(mesh)),
        of_vertices(vertex_normals(mesh)),
        triangles(mesh.triangles),
        neighbours(triangle_neighbours(mesh.triangles)) {}

  [[nodiscard]] Eigen::Vector3d normal(const SurfacePoint& at) const {
    const Eigen::Vector3d own = of_triangles.col(at.triangle);
    for (int k = 0; k < 3; ++k) {
      if (at.barycentric[k] == 1) return of_vertices.col(triangles(k, at.triangle));
    }
    for (int k = 0; k < 3; ++k) {
      const int across = at.barycentric[(k + 2) % 3] == 0 ? neighbours(k, at.triangle) : -1;
      if (across < 0) continue;
      const Eigen::Vector3d other = of_triangles.col(across);
      // A triangle without area has no normal.
      if (!own.allFinite()) return other;
      if (other.allFinite()) return own + other;
    }
    return own;
  }
};

/// Finds the border of a surface.
class Border {
 public:
  explicit Border(const TriangleMesh& surface)
      : triangles_(surface.triangles),
        neighbours_(triangle_neighbours(surface.triangles)),
        vertices_(static_cast<std::size_t>(surface.vertices.cols()), false) {
    for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
      for (int k = 0; k < 3; ++k) {
        if (neighbours_(k, t) >= 0) continue;
        vertices_[static_cast<std::size_t>(triangles_(k, t))] = true;
        vertices_[static_cast<std::size_t>(triangles_((k + 1) % 3, t))] = true;
      }
    }
  }

  /// The nearest point of a point beyond the border is exactly on the border, except for rounding.
  [[nodiscard]] bool contains(const SurfacePoint& point) const {
    for (int k = 0; k < 3; ++k) {
      const bool at_vertex = point.barycentric[k] >= 1 - kBarycentricTolerance;
      if (at_vertex && vertices_[static_cast<std::size_t>(triangles_(k, point.triangle))])
        return true;
      const bool on_edge = point.barycentric[(k + 2) % 3] <= kBarycentricTolerance;
      if (on_edge && neighbours_(k, point.triangle) < 0) return true;
    }
    return false;
  }

 private:
  const Eigen::Matrix3Xi& triangles_;
  Eigen::Matrix3Xi neighbours_;
  std::vector<bool> vertices_;
};

}  // namespace

ErrorStatistics error_statistics(std::vector<double> errors) {
  std::erase_if(errors, [](double e) { return !std::isfinite(e); });
  if (errors.empty()) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return {.count = 0, .rms = nan, .median = nan, .p90 = nan, .p95 = nan, .max = nan};
  }
  for (double& e : errors) e = std::abs(e);
  std::sort(errors.begin(),
            errors.end());  // sort before summing, so that the order of the errors does not matter
  double sum_of_squares = 0;
  for (const double e : errors) sum_of_squares += e * e;
  return {.count = static_cast<long>(errors.size()),
          .rms = std::sqrt(sum_of_squares / static_cast<double>(errors.size())),
          .median = quantile(errors, 0.5),
          .p90 = quantile(errors, 0.9),
          .p95 = quantile(errors, 0.95),
          .max = errors.back()};
}

ImageF depth_difference(const ImageF& measured, const ImageF& reference) {
  check_same_size("depth_difference()", measured.rows(), measured.cols(), reference);
  return measured - reference;
}

RangeMapScore score_range_map(
    const ImageF& measured, const ImageF& truth,
    const Eigen::Ref<const Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>&
        measurable,
    double max_error) {
  check_same_size("score_range_map()", measured.rows(), measured.cols(), truth);
  check_same_size("score_range_map()", measurable.rows(), measurable.cols(), truth);
  require("score_range_map(): max_error", max_error, above(0), "mm");
  std::vector<double> errors, distances;
  long known = 0, wrong = 0, found = 0, wanted = 0;
  for (Eigen::Index i = 0; i < truth.size(); ++i) {
    const bool has_depth = std::isfinite(measured.data()[i]);
    const bool has_truth = std::isfinite(truth.data()[i]);
    const double error =
        static_cast<double>(measured.data()[i]) - static_cast<double>(truth.data()[i]);
    if (has_depth) {
      ++known;
      if (!has_truth || std::abs(error) > max_error) ++wrong;
      if (has_truth) {
        errors.push_back(error);
        distances.push_back(static_cast<double>(truth.data()[i]));
      }
    }
    if (measurable(i / truth.cols(), i % truth.cols())) {
      ++wanted;
      if (has_depth) ++found;
    }
  }
  return {.error = error_statistics(std::move(errors)),
          .distance = error_statistics(std::move(distances)).median,
          .reconstructed = static_cast<double>(found) / static_cast<double>(wanted),
          .wrong = static_cast<double>(wrong) / static_cast<double>(known)};
}

Eigen::VectorXd distances_to_surface(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                     const TriangleMesh& surface) {
  const SurfaceQuery query(surface);
  const Sides sides(surface);
  Eigen::VectorXd distances(points.cols());
  parallel_for(points.cols(), [&](Eigen::Index i) {
    const ClosestPoint closest = query.closest_point(points.col(i));
    const bool behind = closest.at.triangle >= 0 &&
                        sides.normal(closest.at).dot(points.col(i) - closest.position) < 0;
    distances(i) = behind ? -closest.distance : closest.distance;
  });
  return distances;
}

Eigen::VectorXd distances_in_both(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                  const TriangleMesh& surface, double max_distance) {
  require("distances_in_both(): max_distance", max_distance, above(0), "mm");
  const SurfaceQuery query(surface);
  const Border border(surface);
  Eigen::VectorXd distances(points.cols());
  parallel_for(points.cols(), [&](Eigen::Index i) {
    const ClosestPoint closest = query.closest_point(points.col(i));
    const bool is_common = closest.at.triangle >= 0 && closest.distance <= max_distance &&
                           !border.contains(closest.at);
    distances(i) = is_common ? closest.distance : std::numeric_limits<double>::quiet_NaN();
  });
  return distances;
}

}  // namespace palpate::geometry
