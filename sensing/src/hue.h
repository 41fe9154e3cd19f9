// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::sensing {

/// An angle brought to [-pi, pi].
template <typename T>
[[nodiscard]] inline T wrap(T angle) {
  constexpr T kTurn = 2 * std::numbers::pi_v<T>;
  return angle - kTurn * std::round(angle / kTurn);
}

/// Hue of the HSV colour space [rad], in [0, 2 pi), and saturation in [0, 1]; both 0 for grey.
/// Light that is added to all three channels alike does not change the hue.
struct Hue {
  float angle = 0;
  float saturation = 0;
};
[[nodiscard]] inline Hue hue_of(float red, float green, float blue) {
  const float high = std::max({red, green, blue});
  const float low = std::min({red, green, blue});
  const float range = high - low;
  if (!(range > 0) || !(high > 0)) return {};
  constexpr float kSector = std::numbers::pi_v<float> / 3;
  float sectors = 0;
  if (high == red) {
    sectors = (green - blue) / range + (green < blue ? 6.0F : 0.0F);
  } else if (high == green) {
    sectors = (blue - red) / range + 2;
  } else {
    sectors = (red - green) / range + 4;
  }
  return {kSector * sectors, range / high};
}

}  // namespace palpate::sensing
