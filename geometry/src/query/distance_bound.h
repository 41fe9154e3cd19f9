// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <span>
#include <vector>

#include "palpate/geometry/mesh_distance.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// A surface to which distances are bounded. Coordinates should be near the origin: see
/// `exact_offset`.
struct DistanceTarget {
  TriangleMesh mesh;
  SurfaceQuery query;
  Eigen::Matrix3Xi neighbours;  ///< see `triangle_neighbours`
  Eigen::AlignedBox3d box;      ///< see `bounding_box`

  /// \throws InvalidInput if the mesh is not valid.
  explicit DistanceTarget(TriangleMesh surface);
};

struct BoundGoal {
  double max_gap = 0.01;    ///< as in HausdorffOptions
  double ignore_below = 0;  ///< [mm] distances up to this need not be distinguished
  /// [mm] A triangle with a point farther away is not refined further; its upper bound is infinite.
  double stop_above = std::numeric_limits<double>::infinity();
};

/// Triangles of the target whose points are all that an upper bound depends on: it holds for every
/// target that has them.
struct Witnesses {
  static constexpr int kMost = 4;
  std::array<int, kMost> triangles = {};
  int count = 0;  ///< more than kMost: there are others that are not listed

  [[nodiscard]] bool is_complete() const { return count <= kMost; }
  [[nodiscard]] std::span<const int> all() const {
    return {triangles.data(), static_cast<std::size_t>(count)};
  }
  void add(int triangle);
};

struct TriangleBound {
  LargestDistance largest;
  Witnesses witnesses;
};

/// Bounds the largest distance of the points of each of the triangles `which`. Triangles below the
/// overall maximum are refined only as far as needed to show this. Precondition: `from` is a valid
/// mesh.
/// \throws InvalidInput if a distance overflows.
[[nodiscard]] std::vector<TriangleBound> bound_triangle_distances(const TriangleMesh& from,
                                                                  std::span<const int> which,
                                                                  const DistanceTarget& to,
                                                                  const BoundGoal& goal);

/// The largest of the bounds of all triangles; see `one_sided_hausdorff_distance`.
[[nodiscard]] LargestDistance bound_largest_distance(const TriangleMesh& from,
                                                     const DistanceTarget& to,
                                                     const BoundGoal& goal);

}  // namespace palpate::geometry
