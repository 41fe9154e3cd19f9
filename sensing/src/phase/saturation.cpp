// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/saturation.h"

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

/// A value is clipped iff it is within half an 8-bit step of full scale.
constexpr float kFullScale = 1 - 0.5F / 255;

PALPATE_HOT_LOOP void add_clipped(const float* values, std::uint8_t* clipped, long count) {
  for (long i = 0; i < count; ++i) clipped[i] = values[i] >= kFullScale ? 1 : clipped[i];
}

}  // namespace

void find_clipped(const std::vector<Plane>& channels, Mask& clipped) {
  clipped.setZero(channels[0].rows(), channels[0].cols());
  for (const Plane& channel : channels) add_clipped(channel.data(), clipped.data(), clipped.size());
}

}  // namespace palpate::sensing
