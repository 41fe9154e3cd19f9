// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/modulation.h"

#include <gtest/gtest.h>

#include "not_finite.h"

namespace palpate::sensing {
namespace {

Mask row(std::uint8_t a, std::uint8_t b, std::uint8_t c, std::uint8_t d, std::uint8_t e) {
  Mask mask(1, 5);
  mask << a, b, c, d, e;
  return mask;
}

TEST(Modulation, MustReachAnAmplitudeInTheLight) {
  Plane half(1, 5);  // of the amplitudes 0.1, 0.2, 0.3, 0.4, 0.5
  half << 0.05F, 0.1F, 0.15F, 0.2F, 0.25F;
  Mask modulated;
  find_modulated({0.6F * half, -0.8F * half, {}}, row(1, 1, 1, 1, 0), 0.25, modulated);
  EXPECT_TRUE((modulated == row(0, 0, 1, 1, 0)).all());
}

TEST(Modulation, IsDroppedWhereThePhaseIsTooUncertainOrHasNoDeviation) {
  Plane sigma(1, 5);
  sigma << 0.1F, 0.3F, static_cast<float>(kNaN), static_cast<float>(kInf), 0.1F;
  Mask modulated = row(1, 1, 1, 1, 0);
  drop_uncertain(sigma, 0.2, modulated);
  EXPECT_TRUE((modulated == row(1, 0, 0, 0, 0)).all());
}

}  // namespace
}  // namespace palpate::sensing
