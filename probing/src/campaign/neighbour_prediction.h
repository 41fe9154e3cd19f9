// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "campaign/adaptive_site.h"

namespace palpate::probing {

/// The known contacts nearest to a contact, without itself: their distances [mm] and indices.
[[nodiscard]] std::vector<std::pair<double, std::size_t>> neighbours_of(
    const std::vector<AdaptiveSite>& sites, std::size_t index);

/// Predicts a contact from its neighbours by a local plane: least squares weighted by inverse
/// squared distances. Sets its `left_out`. Contacts at a border, or with few neighbours, are
/// predicted by their mean, with the same weights, and set `around`: the error of that, less the
/// smaller distances between contacts (`geometry::error_growth`).
void leave_out(std::vector<AdaptiveSite>& sites, std::size_t index);

}  // namespace palpate::probing
