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
/// Weights >= 0 of contacts; they sum to 1.
using WeightRow = std::vector<ContactWeight>;

/// Computes the weights of contacts at each vertex of an intrinsic Delaunay triangulation, by id. A
/// contact has weight 1 at itself. Between contacts the weights are discretely harmonic, and >= 0
/// because the cotangent weights of Delaunay edges are (Bobenko and Springborn 2007). For a helper
/// only the few largest weights are kept.
/// \param contact_of_id -1 for a helper; each component has a contact.
[[nodiscard]] std::vector<WeightRow> spread_weights(const IntrinsicTriangulation& surface,
                                                    const std::vector<int>& contact_of_id);

/// Merges entries of the same contact and keeps the three largest, sorted. The fourth largest
/// weight is subtracted from each, so that a weight becomes zero before another replaces it and the
/// result depends continuously on the row (except where four weights are equal).
void reduce_to_three(WeightRow& row);

}  // namespace palpate::geometry
