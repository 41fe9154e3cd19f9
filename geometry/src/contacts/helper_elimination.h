// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "contacts/contact_weights.h"
#include "contacts/intrinsic_triangulation.h"

namespace palpate::geometry {

/// Adds helpers until no edge begins and ends in the same vertex, no two edges have the same ends
/// and no two triangles the same corners, so that the triangulation is a simplicial complex.
/// Helpers are needed where the surface is thin relative to the distance of contacts, as around a
/// finger. A helper is the tracked point nearest to the middle of such an edge, or that middle
/// itself.
/// \param add_position `add_position(id, a, b)` is called for a new middle of the edge from a to b.
/// \return false if the process did not terminate.
[[nodiscard]] bool make_simplicial(IntrinsicTriangulation& surface,
                                   const std::function<void(int id, int a, int b)>& add_position);

/// Flips edges at helpers into edges between contacts where the metric allows it, and then flips
/// edges between triangles of contacts to Delaunay. A simplicial triangulation stays simplicial.
/// \param contact_of_id -1 for a helper.
void turn_edges_to_contacts(IntrinsicTriangulation& surface, const std::vector<int>& contact_of_id);

/// Returns the triangles between contacts. First come those of the triangulation. If helpers are
/// left, each is merged into its contact of largest weight (`rows`: weights by id); the resulting
/// triangles are added, smallest first, unless an edge would get a second triangle on one side or a
/// triangle would fold back onto its neighbour.
/// \param places positions of the contacts, 3 x k.
[[nodiscard]] std::vector<std::array<int, 3>> triangles_of_contacts(
    const IntrinsicTriangulation& surface, const std::vector<int>& contact_of_id,
    const std::vector<WeightRow>& rows, const Eigen::Matrix3Xd& places);

}  // namespace palpate::geometry
