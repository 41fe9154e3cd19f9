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

/// How the triangles meet.
struct Gluing {
  /// Of each triangle, whether one of its edges has more than two triangles or two that are turned
  /// against each other.
  std::vector<char> bad_edge;
  /// Of each vertex, in how many fans its triangles come; 1 at a vertex where a manifold is one.
  std::vector<int> fans;
};

[[nodiscard]] Gluing gluing(const TriangleMesh& mesh);

/// Rids a mesh of triangles that are almost lines, as far as that moves its surface by no more than
/// their height: at the border they are dropped, elsewhere their longest edge is flipped. That may
/// be further than the tolerance: those with three `fixed` vertices stay.
void mend_slivers(TriangleMesh& mesh, const std::vector<char>& fixed);

/// What a decimated mesh is measured by.
struct DecimationStandard {
  DistanceTarget input;
  Gluing input_gluing;
  bool manifold_edges;                        ///< of the input
  Eigen::Matrix3Xd normals;                   ///< of the input's triangles
  std::vector<std::array<int, 3>> triangles;  ///< of the input, each from its least corner on

  explicit DecimationStandard(const TriangleMesh& mesh);
};

/// What breaks that which `Decimation` promises. What is quicker to find is looked for first, and
/// the rest only where there is none of it.
struct Unfit {
  std::vector<int> shapes;  ///< triangles that are badly glued, or turned over and no slivers
  /// Triangles further from the input than the tolerance, or the nearest ones to what is `lost`.
  std::vector<int> far;
  std::vector<Eigen::Vector3d> lost;  ///< points of the input further away than the tolerance

  [[nodiscard]] std::size_t count() const { return far.size() + shapes.size(); }
  /// How far from fit: the checks that are still to come, then how much this one found.
  [[nodiscard]] std::pair<int, std::size_t> left() const {
    return {!shapes.empty() ? 2 : !lost.empty() ? 1 : 0, count()};
  }
};

/// Triangles, each from its least corner on, sorted, that are within the tolerance of the input.
struct KnownNear {
  std::vector<std::array<int, 3>> near;
};

/// What is unfit of `candidate`, whose vertices are those of the input. Infinite `tolerance`: the
/// distance does not count. `known`: of candidates with this tolerance; what is learnt is added.
[[nodiscard]] Unfit find_unfit(const TriangleMesh& candidate,
                               const DistanceTarget& candidate_target,
                               const DecimationStandard& standard, double tolerance,
                               KnownNear& known);

}  // namespace palpate::geometry
