// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "palpate/geometry/mesh_distance.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// A surface that the distances of others are bounded to.
struct DistanceTarget {
  TriangleMesh mesh;
  SurfaceQuery query;
  Eigen::Matrix3Xi neighbours;  ///< see `triangle_neighbours`
  double diagonal;              ///< [mm] of the bounding box

  /// \throws InvalidInput if the mesh is not valid.
  explicit DistanceTarget(TriangleMesh surface);
};

struct BoundGoal {
  double max_gap = 0.01;    ///< as in HausdorffOptions
  double ignore_below = 0;  ///< [mm] distances up to here need not be told apart
  /// [mm] A triangle with a point further away is left at that, its upper bound infinite.
  double stop_above = std::numeric_limits<double>::infinity();
};

/// The distances of the points of each triangle. Where they are below the largest of all, only as
/// far as that shows. Pre: `from` is a valid mesh.
/// \throws InvalidInput if a distance is beyond the range of double.
[[nodiscard]] std::vector<LargestDistance> bound_triangle_distances(const TriangleMesh& from,
                                                                    const DistanceTarget& to,
                                                                    const BoundGoal& goal);

/// The largest of these; see `one_sided_hausdorff_distance`.
[[nodiscard]] LargestDistance bound_largest_distance(const TriangleMesh& from,
                                                     const DistanceTarget& to,
                                                     const BoundGoal& goal);

}  // namespace palpate::geometry
