// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// What can be wrong with a mesh. The first three `check_mesh` refuses, so nothing else here works
/// on a mesh that has them.
enum class DefectKind {
  infinite_vertex,      ///< a coordinate is infinite or NaN
  corner_out_of_range,  ///< a triangle names a vertex that is not there
  corner_repeated,      ///< a triangle names a vertex twice
  triangle_repeated,    ///< the same three vertices as an earlier triangle, whichever way round
  triangle_turned,      ///< runs along an edge the same way as an earlier triangle
  edge_overfull,        ///< a third or further triangle at an edge
  vertex_pinched,       ///< its triangles form several fans, as at the tip of two cones
  vertex_isolated,      ///< in no triangle
  triangle_flat,        ///< no area: three vertices in line or at one place
  triangle_needle       ///< height below kNeedleHeight times the longest side
};

/// A triangle is a needle iff its least height is below this fraction of its longest side: its
/// normal and angles begin to suffer from noise, but every function here works on it.
inline constexpr double kNeedleHeight = 1e-3;

struct MeshDefect {
  DefectKind kind = DefectKind::infinite_vertex;
  std::vector<int> elements;  ///< vertices or triangles, by the kind; ascending, never empty
};

/// Everything that is wrong with a mesh, in the order of `DefectKind`; empty iff nothing is. Never
/// throws on a bad mesh. What depends on sound corners is looked for in the triangles that have
/// them.
[[nodiscard]] std::vector<MeshDefect> find_defects(const TriangleMesh& mesh);

/// The kind's name as in the enumeration.
[[nodiscard]] const char* to_string(DefectKind kind);

/// In words: how many, what, and the first few by index.
[[nodiscard]] std::string describe(const MeshDefect& defect);

}  // namespace palpate::geometry
