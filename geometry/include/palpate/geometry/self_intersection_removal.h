// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct SelfIntersectionRemovalOptions {
  /// Called in the calling thread now and then with the numbers of triangles that no longer
  /// intersect and that did; the last call has done == total. If it throws, the removal ends.
  std::function<void(int done, int total)> progress = {};
};

struct SelfIntersectionRemoval {
  TriangleMesh mesh;
  /// Input vertex of each vertex, or -1 if it is new, to copy attributes. Vertices where triangles
  /// intersected may have moved.
  std::vector<int> source;
  int found = 0;  ///< intersecting triangles of the input (see `intersecting_triangles`)
  int left = 0;   ///< those of the result
};

/// Removes intersections of neighbouring parts of a surface, as noise, folds and spikes cause them:
/// smooths the places, or cuts them out and fills the holes (experimental in CGAL 5.5). The rest of
/// the mesh stays as it is, and the surface keeps its topology. If distant parts or two surfaces
/// pass through each other, the mesh does not tell which of them is wrong: these triangles stay,
/// and are counted in `left`. The mesh must be manifold and oriented: see `repair_mesh`.
///
/// Takes about half a millisecond of processor time per intersecting triangle, up to two in large
/// meshes.
/// \throws InvalidInput if the mesh is not valid or not manifold.
/// \throws SolverError if CGAL fails.
/// \throws Unavailable if the library was built without CGAL.
[[nodiscard]] SelfIntersectionRemoval remove_self_intersections(
    const TriangleMesh& mesh, const SelfIntersectionRemovalOptions& options = {});

}  // namespace palpate::geometry
