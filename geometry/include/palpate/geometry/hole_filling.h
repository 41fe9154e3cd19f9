// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct HoleFillingOptions {
  /// [mm] a border loop is a hole, and filled, iff the diagonal of its bounding box is at most
  /// this; > 0, infinity for every loop, the outline of an open surface too. To be set.
  double max_diameter = 0;
};

struct FilledMesh {
  /// Vertices and triangles of the input in their order, then those of the patches.
  TriangleMesh mesh;
  int filled = 0;  ///< holes
  int left = 0;    ///< border loops that are larger, or that no triangles could be found for
};

/// Closes holes with patches as dense as their rim that continue the surface smoothly (Liepa 2003,
/// by CGAL). The mesh must be manifold and oriented: see `repair_mesh`.
/// \throws InvalidInput on a bad mesh or one that is not manifold, or unless max_diameter > 0;
/// SolverError naming the hole where CGAL fails; Unavailable if the library was built without CGAL.
[[nodiscard]] FilledMesh fill_holes(const TriangleMesh& mesh, const HoleFillingOptions& options);

}  // namespace palpate::geometry
