// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "image/image_plane.h"

namespace palpate::sensing {

/// [rad]
inline constexpr double kFullTurn = 2 * std::numbers::pi;

/// Wraps an angle to [-pi, pi].
template <typename T>
[[nodiscard]] inline T wrap(T angle) {
  constexpr auto kTurn = static_cast<T>(kFullTurn);
  return angle - kTurn * std::round(angle / kTurn);
}

/// The same without rounding, for loops that are vectorised: in [-pi, pi] for angles in [-3 pi, 3
/// pi].
[[gnu::always_inline]] inline float turned_back(float angle) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const float down = angle > kPi ? angle - 2 * kPi : angle;
  return down < -kPi ? down + 2 * kPi : down;
}

/// Hue of the HSV colour space [rad], in [0, 2 pi), and saturation in [0, 1]; both 0 for grey.
/// Adding the same light to all three channels does not change the hue.
struct Hue {
  float angle = 0;
  float saturation = 0;
};
[[nodiscard]] inline Hue hue_of(float red, float green, float blue) {
  const float high = std::max(std::max(red, green), blue);
  const float low = std::min(std::min(red, green), blue);
  const float range = high - low;
  // Selections instead of branches, so that the compiler can vectorise loops.
  const float turn = green < blue ? 6.0F : 0.0F;
  const float other_difference = high == green ? blue - red : red - green;
  const float other_sectors = high == green ? 2.0F : 4.0F;
  const float difference = high == red ? green - blue : other_difference;
  const float sectors = high == red ? turn : other_sectors;
  constexpr float kSector = std::numbers::pi_v<float> / 3;
  const float divisor = range > 0 ? range : 1;
  return {kSector * (difference / divisor + sectors), high > 0 ? range / high : 0};
}

/// Computes the hue of each pixel.
void find_hues(const Plane& red, const Plane& green, const Plane& blue, Plane& hue);

}  // namespace palpate::sensing
