// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"
#include "query/distance_bound.h"

namespace palpate::geometry {

/// How the triangles of a mesh are connected.
struct Gluing {
  /// For each triangle, whether one of its edges has more than two triangles or two of opposite
  /// orientation.
  std::vector<char> bad_edge;
  /// For each vertex, the number of fans its triangles form; 1 where the mesh is manifold.
  std::vector<int> fans;
};

[[nodiscard]] Gluing gluing(const TriangleMesh& mesh);

/// Removes almost degenerate triangles as far as this moves the surface by no more than their
/// height: at the border they are dropped, elsewhere their longest edge is flipped. Since the
/// height may exceed the tolerance, triangles with three `fixed` vertices stay.
void mend_slivers(TriangleMesh& mesh, const std::vector<char>& fixed);

/// The reference for checking a decimated mesh.
struct DecimationStandard {
  DistanceTarget input;
  Gluing input_gluing;
  bool manifold_edges;                        ///< whether the input's edges are manifold
  Eigen::Matrix3Xd normals;                   ///< of the input's triangles
  std::vector<std::array<int, 3>> triangles;  ///< of the input, each starting at its lowest corner

  explicit DecimationStandard(const TriangleMesh& mesh);
};

/// Violations of what `Decimation` promises. Cheaper checks come first, and the others run only if
/// these find nothing.
struct Unfit {
  std::vector<int> shapes;  ///< badly connected triangles, or flipped ones that are not slivers
  /// Triangles whose distance from the input exceeds the tolerance, or those nearest to `lost`.
  std::vector<int> far;
  std::vector<Eigen::Vector3d> lost;  ///< input points whose distance exceeds the tolerance

  [[nodiscard]] std::size_t count() const { return far.size() + shapes.size(); }
  /// Measure of progress: number of checks still to pass, then number of violations found.
  [[nodiscard]] std::pair<int, std::size_t> left() const {
    return {!shapes.empty() ? 2 : !lost.empty() ? 1 : 0, count()};
  }
};

/// Triangles known to be within the tolerance of the input, sorted, each from its lowest corner.
struct KnownNear {
  std::vector<std::array<int, 3>> near;
};

/// Finds the violations of `candidate`, whose vertices are a subset of the input's. An infinite
/// `tolerance` skips the distance check. `known` collects results for candidates with the same
/// tolerance and is extended.
[[nodiscard]] Unfit find_unfit(const TriangleMesh& candidate,
                               const DistanceTarget& candidate_target,
                               const DecimationStandard& standard, double tolerance,
                               KnownNear& known);

}  // namespace palpate::geometry
