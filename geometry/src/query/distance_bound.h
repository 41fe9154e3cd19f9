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

/// A surface to which distances are bounded.
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
  double ignore_below = 0;  ///< [mm] distances up to this need not be distinguished
  /// [mm] A triangle with a point farther away is not refined further; its upper bound is infinite.
  double stop_above = std::numeric_limits<double>::infinity();
};

/// Bounds the largest distance of each triangle's points. Triangles below the overall maximum are
/// refined only as far as needed to show this. Precondition: `from` is a valid mesh.
/// \throws InvalidInput if a distance overflows.
[[nodiscard]] std::vector<LargestDistance> bound_triangle_distances(const TriangleMesh& from,
                                                                    const DistanceTarget& to,
                                                                    const BoundGoal& goal);

/// The largest of these; see `one_sided_hausdorff_distance`.
[[nodiscard]] LargestDistance bound_largest_distance(const TriangleMesh& from,
                                                     const DistanceTarget& to,
                                                     const BoundGoal& goal);

}  // namespace palpate::geometry
