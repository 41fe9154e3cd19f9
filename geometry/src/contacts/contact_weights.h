// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "contacts/intrinsic_triangulation.h"

namespace palpate::geometry {

struct ContactWeight {
  int contact;
  double weight;
};
/// Weights >= 0 of some contacts, which sum to 1.
using WeightRow = std::vector<ContactWeight>;

/// The weights of the contacts at each vertex of an intrinsic Delaunay triangulation, by id: a
/// contact's own is 1; between contacts they are discretely harmonic, and so >= 0, because the
/// cotangent weights of Delaunay edges are (Bobenko and Springborn 2007). Of a helper's weights the
/// largest few are kept. `contact_of_id`: -1 for a helper; each component has a contact.
[[nodiscard]] std::vector<WeightRow> spread_weights(const IntrinsicTriangulation& surface,
                                                    const std::vector<int>& contact_of_id);

/// Merges the entries of one contact and leaves at most three, the largest first: from each weight
/// the fourth largest is taken off, so that a weight goes to zero before another takes its place
/// and the result depends continuously on the row (but where four weights are equal).
void reduce_to_three(WeightRow& row);

}  // namespace palpate::geometry
