// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/eigen_alignment.h"

namespace palpate::geometry {

/// The meaning, unit and range of each field stand in its list, `visit`.
struct CloudClusterOptions {
  std::optional<double> max_gap = {};  ///< must be given
  int min_points = 1;
  /// Called after each part of the work; the last call has done == total. If it throws, the work
  /// ends.
  std::function<void(int done, int total)> progress = {};
};

void visit(CloudClusterOptions& options, FieldVisitor& visitor);

struct CloudClusters {
  std::vector<int> cluster;  ///< N: 0 is the largest; -1: in none, or not known
  std::vector<int> sizes;    ///< points of each cluster, descending; ties by their first point
};

/// Divides a cloud (3 x N [mm]) into the connected components of the graph that joins points at
/// most `max_gap` apart. Points with a coordinate that is not finite are in no cluster. The result
/// does not depend on the order of the points (except for ties in size) or the number of threads.
/// \throws InvalidInput if an option is outside its range, or max_gap is less than 2^-40 of the
/// extent of the points.
[[nodiscard]] CloudClusters cloud_clusters(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                           const CloudClusterOptions& options);

}  // namespace palpate::geometry
