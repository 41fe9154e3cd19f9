// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct FarthestPointOptions {
  double spacing = 0;                           ///< [mm] least distance of two points; > 0
  int count = std::numeric_limits<int>::max();  ///< most points; > 0
};

/// Vertices that cover a surface evenly.
struct FarthestPoints {
  /// In the order of selection: each prefix is a coarser cover.
  std::vector<int> vertices;
  /// [mm] Largest distance of a candidate from the first k + 1 points; infinity while a part of the
  /// surface has none.
  std::vector<double> cover;
};

/// Selects vertices in farthest-point order (Gonzalez 1985; Moenning and Dodgson 2003): each is the
/// candidate whose distance along the surface to those before it is largest, until no candidate is
/// `spacing` away. Distances are those of `geodesic_distance` by fast marching. The first is the
/// candidate nearest to the mean of all candidates; ties go to the lowest vertex. A vertex without
/// triangles is left out.
/// \param candidates vertices of the mesh.
/// \throws InvalidInput if the mesh is not valid, an option is outside its range, or a candidate is
/// not a vertex.
[[nodiscard]] FarthestPoints farthest_points(const TriangleMesh& mesh,
                                             std::span<const int> candidates,
                                             const FarthestPointOptions& options);

}  // namespace palpate::geometry
