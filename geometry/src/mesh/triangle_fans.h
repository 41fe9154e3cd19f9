// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Data with which a wave travels from a vertex to its neighbours, grouped by vertex in memory.
struct TriangleFans {
  /// The other end of an edge.
  struct Neighbour {
    int vertex;
    double length;   ///< of the edge
    double squared;  ///< its square
    double inverse;  ///< of the square; infinite for an edge without length
  };

  /// A triangle seen from one of its corners; the other two are among that corner's neighbours.
  struct Corner {
    int next, last;
    double dot;    ///< product of the two edges
    double cross;  ///< square of their cross product; > 0 unless an edge has no length
  };

  std::vector<int> first_neighbour;  ///< V + 1: index of each vertex's first neighbour
  std::vector<int> first_corner;     ///< V + 1: index of each vertex's first corner
  std::vector<Neighbour> neighbours;
  std::vector<Corner> corners;
  std::vector<double> longest;  ///< V, length of the longest edge
  std::vector<char> turns;      ///< V, nonzero if paths bend there, around a corner of the border
};

/// The half-edges 3 t + k that leave each vertex: those of vertex v are number first[v] to
/// first[v + 1] - 1. `first` is set, V + 1.
[[nodiscard]] std::vector<int> half_edges_by_vertex(const TriangleMesh& mesh,
                                                    std::vector<int>& first);

/// Computes the fans of a mesh that `check_mesh` accepts.
[[nodiscard]] TriangleFans triangle_fans(const TriangleMesh& mesh);

}  // namespace palpate::geometry
