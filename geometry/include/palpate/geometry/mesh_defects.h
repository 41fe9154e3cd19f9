// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Defects of a mesh. `check_mesh` rejects the first three, so other functions cannot handle meshes
/// that have them.
enum class DefectKind {
  infinite_vertex,       ///< a coordinate is infinite or NaN
  corner_out_of_range,   ///< a triangle refers to a vertex that does not exist
  corner_repeated,       ///< a triangle refers to a vertex twice
  triangle_repeated,     ///< has the same three vertices as an earlier triangle, in any orientation
  triangle_turned,       ///< has an edge in the same direction as an earlier triangle
  edge_overfull,         ///< a third or further triangle at an edge
  vertex_pinched,        ///< its triangles form several fans, like two cones that meet at the tip
  vertex_isolated,       ///< is part of no triangle
  triangle_flat,         ///< zero area: its vertices are collinear or coincide
  triangle_needle,       ///< height below kNeedleHeight times the longest side
  triangle_intersecting  ///< meets another triangle elsewhere than at shared vertices and edges
};

/// A triangle is a needle if its smallest height is below this fraction of its longest side. Noise
/// starts to affect its normal and angles, but every function works on it.
inline constexpr double kNeedleHeight = 1e-3;

struct MeshDefect {
  DefectKind kind = DefectKind::infinite_vertex;
  std::vector<int>
      elements;  ///< vertices or triangles, depending on the kind; ascending, not empty
};

/// Finds all defects of a mesh, in the order of `DefectKind`; empty if there are none. Never throws
/// on a bad mesh. Defects that need valid corners are searched among the triangles that have them.
/// Triangles that intersect others take longer to find: `find_all_defects` of
/// `self_intersections.h` finds them too.
[[nodiscard]] std::vector<MeshDefect> find_defects(const TriangleMesh& mesh);

/// Name of a kind as in the enumeration.
[[nodiscard]] const char* to_string(DefectKind kind);

/// Describes a defect in words: how many elements, what is wrong, and the first few indices.
[[nodiscard]] std::string describe(const MeshDefect& defect);

}  // namespace palpate::geometry
