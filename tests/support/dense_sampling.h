// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

/// Distances between meshes by sampling and testing every triangle: slow, and independent of the
/// library.
namespace palpate::geometry::test {

/// Squared distance to a triangle (Eberly's regions, by the constrained minimum of the quadratic).
inline double squared_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                               const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const auto to_segment = [&p](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Eigen::Vector3d along = to - from;
    const double length = along.squaredNorm();
    const double t = length > 0 ? std::clamp((p - from).dot(along) / length, 0.0, 1.0) : 0;
    return (from + t * along - p).squaredNorm();
  };
  const double rim = std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const auto inside = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    return normal.dot((to - from).cross(p - from)) >= 0;
  };
  if (normal.squaredNorm() == 0 || !inside(a, b) || !inside(b, c) || !inside(c, a)) return rim;
  const double height = normal.dot(p - a);
  return std::min(rim, height * height / normal.squaredNorm());
}

/// Distances to a mesh by testing every triangle that its bounding sphere does not exclude.
class EveryTriangle {
 public:
  explicit EveryTriangle(const TriangleMesh& mesh) : mesh_(mesh) {
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
      const Eigen::Vector3d centre =
          mesh.vertices(Eigen::all, mesh.triangles.col(t)).rowwise().mean();
      double radius = 0;
      for (const int v : mesh.triangles.col(t)) {
        radius = std::max(radius, (mesh.vertices.col(v) - centre).norm());
      }
      centres_.push_back(centre);
      radii_.push_back(radius);
    }
  }
  /// [mm] to the nearest triangle; those within `slack` of it are added to `nearest`.
  double distance(const Eigen::Vector3d& point, double slack, std::vector<int>* nearest) const {
    double bound = std::numeric_limits<double>::infinity();
    std::vector<double> to_centre(centres_.size());
    for (std::size_t t = 0; t < centres_.size(); ++t) {
      to_centre[t] = (point - centres_[t]).norm();
      bound = std::min(bound, to_centre[t] + radii_[t]);
    }
    double least = std::numeric_limits<double>::infinity();
    std::vector<std::pair<double, int>> tried;
    for (std::size_t t = 0; t < centres_.size(); ++t) {
      if (to_centre[t] - radii_[t] > bound + slack) continue;
      const Eigen::Vector3i of = mesh_.triangles.col(static_cast<Eigen::Index>(t));
      tried.emplace_back(
          std::sqrt(squared_distance(point, mesh_.vertices.col(of[0]), mesh_.vertices.col(of[1]),
                                     mesh_.vertices.col(of[2]))),
          static_cast<int>(t));
      least = std::min(least, tried.back().first);
    }
    for (const auto& [distance, t] : tried) {
      if (nearest != nullptr && distance <= least + slack) nearest->push_back(t);
    }
    return least;
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<Eigen::Vector3d> centres_;
  std::vector<double> radii_;
};

/// [mm] to the nearest triangle.
inline double brute_force_distance(const Eigen::Vector3d& point, const TriangleMesh& mesh) {
  return EveryTriangle(mesh).distance(point, 0, nullptr);
}

/// Samples of the surface, in rows on each triangle; every point is within `spacing` of a sample.
struct Samples {
  std::vector<Eigen::Vector3d> points;
  double spacing = 0;
};

inline Samples sample(const TriangleMesh& mesh, int count) {
  double area = 0;
  const auto corner = [&mesh](Eigen::Index t, int k) -> Eigen::Vector3d {
    return mesh.vertices.col(mesh.triangles(k, t));
  };
  const auto area_of = [&](Eigen::Index t) {
    return (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).norm() / 2;
  };
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) area += area_of(t);
  Samples samples;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const int n = 1 + static_cast<int>(std::sqrt(2 * count * area_of(t) / area));
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; i + j <= n; ++j) {
        samples.points.push_back(corner(t, 0) +
                                 static_cast<double>(i) / n * (corner(t, 1) - corner(t, 0)) +
                                 static_cast<double>(j) / n * (corner(t, 2) - corner(t, 0)));
      }
    }
    for (int k = 0; k < 3; ++k) {
      samples.spacing =
          std::max(samples.spacing, (corner(t, (k + 1) % 3) - corner(t, k)).norm() / n);
    }
  }
  return samples;
}

/// [mm]
struct Errors {
  double rms = 0;
  double largest = 0;
};

/// Of distances with or without a sign.
inline Errors errors_of(const Eigen::VectorXd& distances) {
  return {std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size())),
          distances.cwiseAbs().maxCoeff()};
}

struct SampledDistance {
  double largest = 0;  ///< [mm] of the samples; other points may be farther by up to `spacing`
  double spacing = 0;  ///< [mm]
};

/// Distances from about `count` points of `from` to `to`.
inline SampledDistance sampled_distance(const TriangleMesh& from, const TriangleMesh& to,
                                        int count) {
  const Samples samples = sample(from, count);
  SampledDistance found{.largest = 0, .spacing = samples.spacing};
  const EveryTriangle triangles(to);
  for (const Eigen::Vector3d& point : samples.points) {
    found.largest = std::max(found.largest, triangles.distance(point, 0, nullptr));
  }
  return found;
}

}  // namespace palpate::geometry::test
