// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/modulation.h"

#include <gtest/gtest.h>

namespace palpate::sensing {
namespace {

/// One row: the same light in each pixel, the sinusoid's amplitude 0.1, 0.2, 0.3, 0.4, 0.5.
Combined rising_amplitude() {
  Plane half(1, 5);
  half << 0.05F, 0.1F, 0.15F, 0.2F, 0.25F;
  return {0.6F * half, -0.8F * half, {}};
}

Demodulated mean_of(float mean) {
  const Plane zero = Plane::Zero(1, 5);
  return {zero, zero, Plane::Constant(1, 5, mean)};
}

Mask modulated(const std::vector<Demodulated>& channels, const ModulationLimits& limits) {
  Mask lit = Mask::Ones(1, 5);
  lit(0, 4) = 0;
  Mask out;
  find_modulated(rising_amplitude(), channels, lit, limits, out);
  return out;
}

Mask row(std::uint8_t a, std::uint8_t b, std::uint8_t c, std::uint8_t d) {
  Mask mask(1, 5);
  mask << a, b, c, d, 0;  // the last is not lit
  return mask;
}

TEST(Modulation, MustReachAnAmplitude) {
  EXPECT_TRUE(
      (modulated({mean_of(1)}, {.colored = false, .min_amplitude = 0.25}) == row(0, 0, 1, 1))
          .all());
}

TEST(Modulation, MustReachAShareOfTheMean) {
  const ModulationLimits limits{.colored = false, .min_amplitude = 0.01, .min_ratio = 0.35};
  EXPECT_TRUE((modulated({mean_of(1)}, limits) == row(0, 0, 0, 1)).all());
  EXPECT_TRUE((modulated({mean_of(0.3F)}, limits) == row(0, 1, 1, 1)).all());
  // Of all channels together.
  EXPECT_TRUE(
      (modulated({mean_of(0.2F), mean_of(0.3F), mean_of(0.5F)}, limits) == row(0, 0, 0, 1)).all());
}

TEST(Modulation, LightThatAllChannelsShareDoesNotCount) {
  // 0.2 + 0.3 + 0.5 less 3 x 0.2: 0.4 of the projector.
  const ModulationLimits limits{.colored = true, .min_amplitude = 0.01, .min_ratio = 0.45};
  EXPECT_TRUE(
      (modulated({mean_of(0.2F), mean_of(0.3F), mean_of(0.5F)}, limits) == row(0, 1, 1, 1)).all());
}

}  // namespace
}  // namespace palpate::sensing
