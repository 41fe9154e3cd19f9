// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/light_step.h"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::sensing {
namespace {

constexpr long kLightRows = 90, kHalfPeriod = 6;

/// Light that depends on the row alone.
template <typename Light>
Plane light_of(const Light& light) {
  Plane plane(kLightRows, 3);
  for (long row = 0; row < kLightRows; ++row)
    plane.row(row).setConstant(static_cast<float>(light(static_cast<double>(row))));
  return plane;
}

TEST(LightStep, IsTheContrastOfTwoSurfaces) {
  Plane contrast;
  for (const double other : {0.34, 0.3, 0.25}) {
    find_light_steps(light_of([&](double row) { return row > 45 ? other : 0.3; }), kHalfPeriod,
                     contrast);
    const double expected = (other - 0.3) / (other + 0.3);
    EXPECT_NEAR(contrast(45, 1), expected, 1e-3) << other;
    EXPECT_NEAR(contrast(20, 1), 0, 1e-6) << other;
  }
}

TEST(LightStep, IsNoneOnEvenShading) {
  Plane contrast;
  find_light_steps(light_of([](double row) { return 0.2 * std::exp(0.01 * row); }), kHalfPeriod,
                   contrast);
  EXPECT_LT(contrast.middleRows(18, kLightRows - 36).abs().maxCoeff(), 1e-5F);
  // Nearer to the ends the shading cannot be continued.
  EXPECT_NEAR(contrast(10, 0), 0.01 * kHalfPeriod, 1e-5);
  EXPECT_TRUE(std::isnan(contrast(5, 0)));
}

}  // namespace
}  // namespace palpate::sensing
