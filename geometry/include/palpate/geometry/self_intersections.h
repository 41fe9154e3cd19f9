// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/mesh_defects.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Finds the triangles that meet another one elsewhere than at vertices and edges that they share
/// (DefectKind::triangle_intersecting), in ascending order. Decided exactly for the coordinates as
/// they are stored: a mere touch counts, such as a vertex in the middle of another triangle's edge,
/// and so does a triangle folded onto its neighbour. Vertices at the same place count as shared.
///
/// Never throws on a bad mesh. Triangles with bad corners and those without area (exactly: their
/// corners are collinear) are left out, as other kinds of defects; one that repeats another one
/// does not count as meeting it. Takes 2 to 8 microseconds of processor time per triangle, most
/// where many lie in one plane; uses all threads.
/// \throws SolverError if there is not enough memory for the search tree.
[[nodiscard]] std::vector<int> intersecting_triangles(const TriangleMesh& mesh);

/// Finds the defects that `find_defects` finds, and then the triangles that intersect others.
/// \throws SolverError if there is not enough memory for the search tree.
[[nodiscard]] std::vector<MeshDefect> find_all_defects(const TriangleMesh& mesh);

}  // namespace palpate::geometry
