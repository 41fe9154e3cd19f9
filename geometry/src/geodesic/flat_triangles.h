// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Half-edge 3 t + k runs from corner k of triangle t to the next one.
[[nodiscard]] inline int next_half_edge(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
[[nodiscard]] inline int last_half_edge(int h) { return h % 3 == 0 ? h + 2 : h - 1; }

/// A half-edge in the plane, from (0, 0) to (length, 0), with its triangle above.
struct FlatHalfEdge {
  double length;
  /// Directions to the apex: from the start, and from the end in the mirrored plane. Both are as
  /// accurate as a double, however different the lengths of the three edges are.
  Eigen::Vector2d left, right;
  int opposite;     ///< half-edge; kNone at the border
  int edge;         ///< the same for both half-edges of an edge
  bool along_edge;  ///< true if the edge runs in this direction; it does in one of the two
  int start;        ///< vertex
};

/// The triangles of a mesh, each laid in a plane.
struct FlatTriangles {
  std::vector<FlatHalfEdge> half_edges;
  int edge_count = 0;
  double unit = 1;  ///< lengths here are this times those of the mesh
  double mean_length = 0;
  std::vector<int> first_leaving;  ///< V + 1: index of each vertex's first half-edge in `leaving`
  std::vector<int> leaving;        ///< half-edges by the vertex at which they start
  std::vector<char> bends;         ///< V, nonzero if shortest paths can bend there

  [[nodiscard]] const FlatHalfEdge& operator[](int h) const {
    return half_edges[static_cast<size_t>(h)];
  }
  /// Position of the apex in the plane of a half-edge.
  [[nodiscard]] Eigen::Vector2d apex(int h) const {
    return (*this)[last_half_edge(h)].length * (*this)[h].left;
  }
  /// The half-edges that start at a vertex.
  [[nodiscard]] std::span<const int> from(int vertex) const {
    const auto v = static_cast<size_t>(vertex);
    return std::span(leaving).subspan(static_cast<size_t>(first_leaving[v]),
                                      static_cast<size_t>(first_leaving[v + 1] - first_leaving[v]));
  }
};

/// Around a vertex as close to a source as this fraction of an edge, rounding leaves gaps between
/// windows; paths may bend there to fill them.
inline constexpr double kClose = 1e-6;

/// Lays the triangles in the plane, scaled by a power of two that brings the largest coordinate
/// near one, so that squares neither over- nor underflow.
/// \throws InvalidInput as `opposite_half_edges`, or naming a triangle without area.
[[nodiscard]] FlatTriangles flat_triangles(const TriangleMesh& mesh);

}  // namespace palpate::geometry
