// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// [mm^2] the areas of all triangles in sum.
/// \throws InvalidInput on a bad mesh.
[[nodiscard]] double surface_area(const TriangleMesh& mesh);

/// [mm^3] what a closed surface encloses, by the divergence theorem: the sum of the tetrahedra
/// a . (b x c) / 6 that the triangles span with one common point. Negative if the triangles are
/// counter-clockwise seen from inside; several closed surfaces add up.
/// \throws InvalidInput on a bad mesh, as `opposite_half_edges`, and naming an edge at the border
/// if the mesh is open.
[[nodiscard]] double enclosed_volume(const TriangleMesh& mesh);

}  // namespace palpate::geometry
