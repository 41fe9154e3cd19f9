// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "palpate/probing/acquisition.h"
#include "samples/realigned_pairs.h"

namespace palpate::haptics {

/// About `most` pairs of the contacts that are allowed, as many for each contact and far apart in
/// force, in their order. With a pair comes that of its group's normal force. Pairs without a force
/// or a displacement are left out.
[[nodiscard]] std::vector<Pair> spread_pairs(const std::vector<Pair>& pairs,
                                             const std::vector<bool>& allowed, std::size_t most);

/// Indices of at most `most` pairs with large forces at contacts that are far apart: of each the
/// largest normal force, then the largest force that was dragged.
[[nodiscard]] std::vector<std::size_t> largest_pairs(const std::vector<Pair>& pairs,
                                                     std::span<const probing::Contact> contacts,
                                                     std::size_t most);

}  // namespace palpate::haptics
