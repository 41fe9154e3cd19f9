// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// [mm^2] sum of the areas of all triangles.
/// \throws InvalidInput if the mesh is not valid.
[[nodiscard]] double surface_area(const TriangleMesh& mesh);

/// [mm^3] volume enclosed by a closed surface, by the divergence theorem: the sum of the signed
/// tetrahedra a . (b x c) / 6 that the triangles span with a common point. Negative if the
/// triangles are counter-clockwise seen from inside. Several closed surfaces add up.
/// \throws InvalidInput if the mesh is not valid, as `opposite_half_edges`, or naming a border edge
/// if the mesh is open.
[[nodiscard]] double enclosed_volume(const TriangleMesh& mesh);

}  // namespace palpate::geometry
