// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct RepairOptions {
  /// Called in the calling thread after each part of the work, and while triangles without area are
  /// removed; the last call has done == total. If it throws, the repair ends.
  std::function<void(int done, int total)> progress = {};
};

struct RepairedMesh {
  TriangleMesh mesh;  ///< oriented and manifold, with border where the surface was open or cut
  /// Input vertex of each vertex, to copy attributes. An input vertex at which fans or sheets were
  /// separated appears several times.
  std::vector<int> source;
  int removed_triangles = 0;  ///< invalid corners, repeated, or zero area without use
  int flipped_edges = 0;      ///< flipped to remove triangles with collinear vertices
  int turned_triangles = 0;   ///< reoriented to match the larger part of their surface
  int welded_vertices = 0;    ///< joined with an earlier vertex at exactly the same place
  int split_vertices = 0;     ///< added where fans or sheets that meet at a vertex were separated
  int removed_vertices = 0;   ///< not finite, or left without triangles
  int cut_edges = 0;          ///< edges between triangles that cannot form one surface
};

/// Repairs a copy of a mesh (see `find_defects`). Every triangle with valid corners and non-zero
/// area is kept; holes left by removed triangles stay open.
///
/// Vertices at exactly the same place are joined. Where more than two triangles meet at an edge,
/// pairs that face the same side stay connected (two solids that touch there are separated), and
/// among those the pairs with the flattest angle. Neighbours of opposite orientation are
/// reoriented like the larger area of their connected surface; a one-sided surface is cut. A
/// triangle that meets such an edge at both ends without being joined there is cut free of its
/// neighbours. A mesh without defects is returned unchanged.
/// \throws InvalidInput if no triangle can be kept.
[[nodiscard]] RepairedMesh repair_mesh(const TriangleMesh& mesh, const RepairOptions& options = {});

}  // namespace palpate::geometry
