// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "palpate/geometry/attribute.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// The attributes of some of the elements, in this order: those of the vertices that `decimate` and
/// `repair_mesh` keep, with their `source`.
/// \throws InvalidInput if an index is out of range.
[[nodiscard]] Attributes selected_attributes(const Attributes& attributes,
                                             std::span<const int> elements);

/// The attributes of the vertices of a mesh at places on it, such as `Remeshing::places`.
///
/// Floating-point numbers and colours (also of integers, then rounded) are linear in each triangle.
/// At a corner that is NaN they are unknown: a place has the mean of the known corners, unless a
/// NaN one is the nearest. Other integers, such as labels, and lists are those of the nearest
/// corner. Normals (nx, ny, nz) are not of unit length in between.
/// \throws InvalidInput if an attribute does not fit the mesh, or a place is not on it.
[[nodiscard]] Attributes interpolated_attributes(const Attributes& attributes,
                                                 const TriangleMesh& mesh,
                                                 std::span<const SurfacePoint> places);

}  // namespace palpate::geometry
