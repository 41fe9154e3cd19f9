// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "palpate/core/fields.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// The meaning, unit and range of each field stand in its list, `visit`.
struct HoleFillingOptions {
  /// Must be given. A border loop is no hole, but the outline of its part of the surface, if the
  /// bounding box of that part is at most 1.05 times as large. Infinity also fills outlines.
  std::optional<double> max_diameter = {};
  /// Called in the calling thread after each border loop; the last call has done == total. If it
  /// throws, the filling ends.
  std::function<void(int done, int total)> progress = {};
};

void visit(HoleFillingOptions& options, FieldVisitor& visitor);

/// \throws InvalidInput if an option is outside its range or missing.
void check_hole_filling(const HoleFillingOptions& options);

struct FilledMesh {
  /// First the vertices and triangles of the input in their order, then those of the patches.
  TriangleMesh mesh;
  int filled = 0;  ///< number of holes filled
  int left = 0;  ///< border loops that are larger or outlines, or for which no triangles were found
};

/// Fills holes with patches that are as dense as their rim and continue the surface smoothly (Liepa
/// 2003, by CGAL). The mesh must be manifold and oriented: see `repair_mesh`.
/// \throws InvalidInput if the mesh is not valid or not manifold, or unless max_diameter > 0.
/// \throws SolverError naming the hole if CGAL fails.
/// \throws Unavailable if the library was built without CGAL.
[[nodiscard]] FilledMesh fill_holes(const TriangleMesh& mesh, const HoleFillingOptions& options);

}  // namespace palpate::geometry
