// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "contacts/contact_weights.h"
#include "contacts/intrinsic_triangulation.h"

namespace palpate::geometry {

/// Adds helpers until no edge begins and ends in one vertex, no two edges have the same ends and no
/// two triangles the same corners, so that the triangulation is one without lengths too. That takes
/// some where the surface is thin against its contacts, as around a finger. A helper is the tracked
/// point nearest to the middle of such an edge, or that middle itself; `add_position(id, a, b)` is
/// told of the latter, the ends being `a` and `b`. False if it did not end.
[[nodiscard]] bool make_simplicial(IntrinsicTriangulation& surface,
                                   const std::function<void(int id, int a, int b)>& add_position);

/// Turns edges at helpers into edges between contacts where the metric allows it, and then flips
/// edges between triangles of contacts to Delaunay. `contact_of_id`: -1 for a helper. What was
/// without equal edges stays so.
void turn_edges_to_contacts(IntrinsicTriangulation& surface, const std::vector<int>& contact_of_id);

/// The triangles of contacts alone: first those of the triangulation; then, where helpers are left,
/// those that it has when each helper is drawn into its heaviest contact (`rows`: the weights by
/// id), the smallest first, as long as no edge gets a second triangle on one side and none is
/// folded back onto its neighbour. `places`: the contacts, 3 x k.
[[nodiscard]] std::vector<std::array<int, 3>> triangles_of_contacts(
    const IntrinsicTriangulation& surface, const std::vector<int>& contact_of_id,
    const std::vector<WeightRow>& rows, const Eigen::Matrix3Xd& places);

}  // namespace palpate::geometry
