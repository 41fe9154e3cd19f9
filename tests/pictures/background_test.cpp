// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "background.h"

#include <gtest/gtest.h>

namespace palpate::pictures {
namespace {

/// `count` depths, evenly from `low` to `high`.
std::vector<double> even(double low, double high, int count) {
  std::vector<double> depths;
  for (int i = 0; i < count; ++i) depths.push_back(low + (high - low) * i / (count - 1));
  return depths;
}

std::vector<double> both(std::vector<double> one, const std::vector<double>& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

TEST(BackgroundBorder, LiesInTheGapBetweenAnObjectAndAWall) {
  const auto border = background_border(both(even(640, 730, 4000), even(828, 832, 20000)));
  ASSERT_TRUE(border);
  EXPECT_GT(*border, 730);
  EXPECT_LT(*border, 828);
}

TEST(BackgroundBorder, IsNotMovedByAFewDepthsInTheGap) {
  const auto border = background_border(
      both(both(even(640, 730, 4000), even(828, 832, 20000)), even(735, 825, 20)));
  ASSERT_TRUE(border);
  EXPECT_GT(*border, 730);
  EXPECT_LT(*border, 828);
}

TEST(BackgroundBorder, IsNotThereWithoutAWideGapOrWithoutAnObject) {
  EXPECT_FALSE(background_border({}));
  EXPECT_FALSE(background_border(even(700, 700, 2000)));
  EXPECT_FALSE(background_border(even(700, 1000, 2000)));
  // A fifth of all.
  EXPECT_FALSE(background_border(both(even(600, 760, 2000), even(810, 850, 2000))));
  // A few specks before a wall.
  EXPECT_FALSE(background_border(both(even(600, 610, 20), even(828, 832, 2000))));
}

}  // namespace
}  // namespace palpate::pictures
