// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "color_map.h"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::pictures {
namespace {

/// Relative luminance of a linear screen is enough to compare neighbours.
double lightness(const Rgb& color) {
  return 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
}

TEST(ColorMap, SequentialGetsLighterAllAlong) {
  for (int step = 1; step <= 40; ++step) {
    EXPECT_GT(lightness(color_at(ColorMap::sequential, step / 40.0)),
              lightness(color_at(ColorMap::sequential, (step - 1) / 40.0)));
  }
}

TEST(ColorMap, DivergingIsBlueThenWhiteThenRed) {
  const Rgb low = color_at(ColorMap::diverging, 0.1);
  const Rgb high = color_at(ColorMap::diverging, 0.9);
  EXPECT_GT(low[2], low[0]);
  EXPECT_GT(high[0], high[2]);
  EXPECT_EQ(color_at(ColorMap::diverging, 0.5), (Rgb{255, 255, 255}));
}

TEST(ColorMap, KeepsTheEndsBeyond) {
  for (const ColorMap map : {ColorMap::sequential, ColorMap::diverging}) {
    EXPECT_EQ(color_at(map, -3), color_at(map, 0));
    EXPECT_EQ(color_at(map, HUGE_VAL), color_at(map, 1));
  }
}

TEST(ColorMap, ShowsNaNInAColourOfNeitherMap) {
  EXPECT_EQ(color_at(ColorMap::sequential, std::nan("")), kUnknownColor);
  for (int step = 0; step <= 1000; ++step) {
    EXPECT_NE(color_at(ColorMap::sequential, step / 1000.0), kUnknownColor);
    EXPECT_NE(color_at(ColorMap::diverging, step / 1000.0), kUnknownColor);
  }
}

}  // namespace
}  // namespace palpate::pictures
