// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct RepairedMesh {
  TriangleMesh mesh;  ///< oriented and manifold, with border where the surface was torn or cut
  /// Vertex of the input that each vertex is, so that attributes can follow. A vertex at which
  /// fans or sheets were cut apart stands there several times.
  std::vector<int> vertex_source;
  int removed_triangles = 0;  ///< broken corners, repeated, or without area and nothing to join
  int flipped_edges = 0;      ///< to get rid of triangles whose vertices lie in line
  int turned_triangles = 0;   ///< to run round as the larger part of their surface does
  int welded_vertices = 0;    ///< at exactly the same place as an earlier one
  int removed_vertices = 0;   ///< not finite, or left without a triangle
  int cut_edges = 0;          ///< where triangles that cannot be one surface were parted
};

/// Mends a copy of a mesh (see `find_defects`): every triangle with sound corners that has an area
/// is kept, the holes of what had to go are left open. Vertices at exactly the same place become
/// one. Where more than two triangles meet at an edge, those pairs stay joined that go on most
/// straightly; where neighbours run against each other they are turned as the larger area of their
/// connected surface has it; a one-sided surface is cut. A mesh without defects comes back as it
/// was.
/// \throws InvalidInput if no triangle can be kept.
[[nodiscard]] RepairedMesh repair_mesh(const TriangleMesh& mesh);

}  // namespace palpate::geometry
