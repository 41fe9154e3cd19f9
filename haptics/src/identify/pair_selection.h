// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "palpate/probing/acquisition.h"
#include "samples/realigned_pairs.h"

namespace palpate::haptics {

struct ContactPairs {
  std::size_t contact = 0;         ///< index
  std::vector<std::size_t> pairs;  ///< indices, ascending
};
/// The pairs of each contact; those of a contact stand together.
[[nodiscard]] std::vector<ContactPairs> by_contact(std::span<const Pair> pairs);

/// The pairs with these indices. Their `settled` are as they were.
[[nodiscard]] std::vector<Pair> chosen_pairs(const std::vector<Pair>& pairs,
                                             const std::vector<std::size_t>& indices);

/// The pairs that are marked, if that of their group's normal force is too.
[[nodiscard]] std::vector<Pair> marked_pairs(const std::vector<Pair>& pairs,
                                             const std::vector<bool>& marked);

/// Pairs that press on contacts which are allowed, as many for each contact and far apart in force,
/// `most` in all or one a contact. With a pair comes that of its group's normal force, also beyond
/// this number.
[[nodiscard]] std::vector<Pair> spread_pairs(const std::vector<Pair>& pairs,
                                             std::span<const probing::Contact> contacts,
                                             const std::vector<bool>& allowed, std::size_t most);

/// Indices of at most `most` pairs with large forces at contacts that are far apart: of each the
/// largest normal force, then the largest force that was dragged from it.
[[nodiscard]] std::vector<std::size_t> largest_pairs(const std::vector<Pair>& pairs,
                                                     std::span<const probing::Contact> contacts,
                                                     std::size_t most);

/// Indices of at most `most` pairs at contacts that are far apart: those of `largest_pairs`, and
/// the smallest normal force of each of these contacts.
[[nodiscard]] std::vector<std::size_t> representative_pairs(
    const std::vector<Pair>& pairs, std::span<const probing::Contact> contacts, std::size_t most);

}  // namespace palpate::haptics
