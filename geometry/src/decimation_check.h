// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "distance_bound.h"
#include "palpate/geometry/triangle_mesh.h"

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
/// their height: at the border they are dropped, elsewhere their longest edge is flipped.
void mend_slivers(TriangleMesh& mesh);

/// What a decimated mesh is measured by.
struct DecimationStandard {
  DistanceTarget input;
  Gluing input_gluing;
  bool manifold_edges;                        ///< of the input
  Eigen::Matrix3Xd normals;                   ///< of the input's triangles
  std::vector<std::array<int, 3>> triangles;  ///< of the input, each from its least corner on

  explicit DecimationStandard(const TriangleMesh& mesh);
};

/// Triangles that break what `Decimation` promises, ascending.
struct Unfit {
  std::vector<int> far;     ///< further from the input than the tolerance, or the input from them
  std::vector<int> shapes;  ///< others: badly glued, or turned over and no slivers

  [[nodiscard]] std::size_t count() const { return far.size() + shapes.size(); }
};

/// What is unfit of `candidate`, whose vertices are those of the input. Infinite `tolerance`: the
/// distance does not count.
[[nodiscard]] Unfit find_unfit(const TriangleMesh& candidate,
                               const DistanceTarget& candidate_target,
                               const DecimationStandard& standard, double tolerance);

}  // namespace palpate::geometry
