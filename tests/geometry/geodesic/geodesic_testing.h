// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "not_finite.h"
#include "palpate/geometry/triangle_mesh.h"
#include "test_surfaces.h"

/// Helpers that tests of geodesic distances share.
namespace palpate::geometry::test {

/// Accuracy of the march on a smooth, well sampled surface, away from the source; relative to the
/// distance.
inline constexpr double kMeanError = 0.0025;
inline constexpr double kMaxError = 0.015;

/// Rounding of a way of some hundred triangles, each some tens of operations; relative to it.
inline constexpr double kWayRounding = 1e-11;

/// Straight distances of the vertices from the source.
inline Eigen::VectorXd straight_distances(const TriangleMesh& mesh, const SurfacePoint& source) {
  return (mesh.vertices.colwise() - position(mesh, source)).colwise().norm();
}

struct RelativeErrors {
  double mean = 0;
  double max = 0;
};

/// Errors relative to true distances, for vertices farther from the source than `near`.
inline RelativeErrors relative_errors(const Eigen::VectorXd& measured, const Eigen::VectorXd& truth,
                                      double near) {
  RelativeErrors errors;
  int count = 0;
  for (Eigen::Index v = 0; v < truth.size(); ++v) {
    if (truth[v] <= near || truth[v] == kInf) continue;
    const double error = std::abs(measured[v] - truth[v]) / truth[v];
    errors.max = std::max(errors.max, error);
    errors.mean += error;
    ++count;
  }
  errors.mean /= count;
  return errors;
}

/// A square plate with a square hole in its middle third.
inline TriangleMesh plate_with_hole(int cells, double spacing) {
  TriangleMesh plate = flat_sheet(3 * cells, 3 * cells, spacing);
  const auto in_hole = [&](const Eigen::Vector3i& t) {
    const Eigen::Vector3d centre =
        (plate.vertices.col(t[0]) + plate.vertices.col(t[1]) + plate.vertices.col(t[2])) / 3;
    const Eigen::Vector3d cell = centre / (cells * spacing);
    return cell.x() > 1 && cell.x() < 2 && cell.y() > 1 && cell.y() < 2;
  };
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < plate.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = plate.triangles.col(t);
    if (!in_hole(corners)) plate.triangles.col(kept++) = corners;
  }
  plate.triangles.conservativeResize(3, kept);
  return plate;
}

/// Returns true if the straight line from p to q in the plane does not pass through the box.
inline bool sees(const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                 const Eigen::AlignedBox2d& box) {
  double enter = 0, leave = 1;
  for (int axis = 0; axis < 2; ++axis) {
    const double step = q[axis] - p[axis];
    const double low = box.min()[axis] - p[axis];
    const double high = box.max()[axis] - p[axis];
    if (step == 0 && (low >= 0 || high <= 0)) return true;
    if (step == 0) continue;
    enter = std::max(enter, std::min(low / step, high / step));
    leave = std::min(leave, std::max(low / step, high / step));
  }
  return enter >= leave;
}

/// Distances on `plate_with_hole` from the corner of the plate at vertex 0. Infinite for the
/// vertices in the hole, which are in no triangle.
inline Eigen::VectorXd distances_around_hole(const TriangleMesh& plate, int cells, double spacing) {
  const double side = cells * spacing;
  constexpr double kTouch = 1e-9;  // mm; a path along the hole is free
  const Eigen::AlignedBox2d hole(Eigen::Vector2d::Constant(side + kTouch),
                                 Eigen::Vector2d::Constant(2 * side - kTouch));
  // The source sees these two corners of the hole.
  std::vector<std::pair<Eigen::Vector3d, double>> starts = {{Eigen::Vector3d::Zero(), 0}};
  for (const auto& corner :
       {Eigen::Vector3d(side, 2 * side, 0), Eigen::Vector3d(2 * side, side, 0)}) {
    starts.emplace_back(corner, corner.norm());
  }
  Eigen::VectorXd distances = Eigen::VectorXd::Constant(plate.vertices.cols(), kInf);
  for (const int v : plate.triangles.reshaped()) {
    for (const auto& [start, distance] : starts) {
      const Eigen::Vector3d to = plate.vertices.col(v);
      if (sees(start, to, hole)) {
        distances[v] = std::min(distances[v], distance + (to - start).norm());
      }
    }
  }
  return distances;
}

}  // namespace palpate::geometry::test
