// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// All that takes a wave from a vertex to its neighbours, one vertex after the other in memory.
struct TriangleFans {
  /// The other end of an edge.
  struct Neighbour {
    int vertex;
    double squared;  ///< length of the edge, squared
  };

  /// A triangle seen from one of its corners, with its other two among that corner's neighbours.
  struct Corner {
    int next, last;
    double dot;    ///< product of the two edges
    double cross;  ///< square of their cross product; > 0 unless an edge has no length
  };

  std::vector<int> first_neighbour;  ///< V + 1: where a vertex's neighbours begin
  std::vector<int> first_corner;     ///< V + 1: where its corners begin
  std::vector<Neighbour> neighbours;
  std::vector<Corner> corners;
  std::vector<double> longest;  ///< V, length of the longest edge
  std::vector<char> turns;      ///< V, whether ways turn there, into what a border's corner hides
};

/// The fans of a mesh that check_mesh accepts.
[[nodiscard]] TriangleFans triangle_fans(const TriangleMesh& mesh);

}  // namespace palpate::geometry
