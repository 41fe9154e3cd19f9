// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "palpate/geometry/triangle_mesh.h"

/// What tests of geodesic distances share.
namespace palpate::geometry::test {

/// What the march promises on a smooth, well sampled surface, away from the source; relative to the
/// distance.
inline constexpr double kMeanError = 0.0025;
inline constexpr double kMaxError = 0.015;

/// Of a way of some hundred triangles, each some tens of operations; relative to the distance.
inline constexpr double kWayRounding = 1e-11;

/// Of the vertices.
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
    if (truth[v] <= near) continue;
    const double error = std::abs(measured[v] - truth[v]) / truth[v];
    errors.max = std::max(errors.max, error);
    errors.mean += error;
    ++count;
  }
  errors.mean /= count;
  return errors;
}

}  // namespace palpate::geometry::test
