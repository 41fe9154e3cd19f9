// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "palpate/haptics/pressing_estimate.h"

namespace palpate::haptics {

/// Indices of the contacts nearest to each: itself, then up to `count` others in order of distance
/// (of equal ones, the lower index first) that were pressed from the same side of the object, at
/// less than 90 degrees. Takes a time of the order of N log N. Precondition: count > 0, and all
/// numbers are finite.
[[nodiscard]] std::vector<std::vector<std::size_t>> nearest_contacts(
    std::span<const PressedContact> contacts, std::size_t count);

}  // namespace palpate::haptics
