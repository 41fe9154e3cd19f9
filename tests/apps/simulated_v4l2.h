// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace palpate::apps {

/// Value of a pixel of the simulated camera of V4L2: frames, rows, columns and channels differ.
inline std::uint8_t simulated_value(std::uint64_t frame, std::uint32_t row, std::uint32_t column,
                                    std::uint32_t channel) {
  return static_cast<std::uint8_t>(7 * frame + 2 * row + column + 40 * channel);
}

}  // namespace palpate::apps
