// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_score.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "not_finite.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// A wall at 1000 mm in four columns; nothing in the fifth.
struct Wall {
  ImageF truth = ImageF::Constant(2, 5, 1000.0F);
  ImageF measured;
  PixelMask lit = PixelMask::Constant(2, 5, true);

  Wall() {
    truth.col(4).setConstant(kUnknown);
    measured = truth;
    measured(0, 0) = 1000.5F;
    measured(0, 1) = 989.0F;    // more than 1 % off
    measured(1, 1) = kUnknown;  // no depth
    measured(1, 2) = 1009.0F;   // less than 1 % off
    measured(0, 4) = 900.0F;    // a depth where there is no surface
    lit(0, 3) = false;          // in shadow, but with a depth
  }
};

TEST(RangeMapScore, CoverageIsTheShareOfTheMeasurablePixelsThatHaveADepth) {
  const Wall wall;
  const RangeMapScore score = score_range_map(wall.measured, wall.truth, wall.lit);
  EXPECT_EQ(score.measurable, 7);  // lit, and a surface is there
  EXPECT_EQ(score.covered, 6);     // the wrong one too
  EXPECT_DOUBLE_EQ(score.coverage, 6.0 / 7);
  EXPECT_DOUBLE_EQ(score.distance, 1000);
}

TEST(RangeMapScore, AllPixelsWithATrueDepthAreMeasurableWithoutAMask) {
  const Wall wall;
  const RangeMapScore score = score_range_map(wall.measured, wall.truth);
  EXPECT_EQ(score.measurable, 8);
  EXPECT_DOUBLE_EQ(score.coverage, 7.0 / 8);
}

TEST(RangeMapScore, ADepthIsWrongIfItIsOnePercentOffOrNothingIsThere) {
  const Wall wall;
  const RangeMapScore score = score_range_map(wall.measured, wall.truth, wall.lit);
  EXPECT_EQ(score.measured, 8);  // lit or not
  EXPECT_EQ(score.wrong, 2);
  EXPECT_DOUBLE_EQ(score.wrong_share, 2.0 / 8);
  PixelMask wrong = PixelMask::Constant(2, 5, false);
  wrong(0, 1) = wrong(0, 4) = true;
  EXPECT_TRUE((score.wrong_pixels == wrong).all());
}

TEST(RangeMapScore, ErrorsAreThoseOfDepthsThatAreNotWrong) {
  Wall wall;
  wall.truth(0, 3) = 500;  // the same error is twice as large there, relative to the depth
  wall.measured(0, 3) = 499.5F;
  const RangeMapScore score = score_range_map(wall.measured, wall.truth, wall.lit);
  EXPECT_EQ(score.error.count, 6);
  EXPECT_DOUBLE_EQ(score.error.max, 9);
  EXPECT_DOUBLE_EQ(score.error.rms, std::sqrt((0.5 * 0.5 + 0.5 * 0.5 + 81) / 6));
  EXPECT_DOUBLE_EQ(score.relative_error.rms,
                   std::sqrt((0.0005 * 0.0005 + 0.001 * 0.001 + 0.009 * 0.009) / 6));
  EXPECT_EQ(score.difference(0, 0), 0.5F);
  EXPECT_EQ(score.difference(0, 3), -0.5F);  // measured minus true
  for (const auto& [row, col] : {std::pair(0, 1), std::pair(1, 1), std::pair(0, 4)})
    EXPECT_TRUE(std::isnan(score.difference(row, col)));
}

TEST(RangeMapScore, IsUnknownWhereThereIsNothingToScore) {
  const Wall wall;
  const ImageF nothing = ImageF::Constant(2, 5, kUnknown);
  const RangeMapScore blind = score_range_map(nothing, wall.truth, wall.lit);
  EXPECT_EQ(blind.coverage, 0);
  EXPECT_TRUE(std::isnan(blind.wrong_share));
  EXPECT_EQ(blind.error.count, 0);
  const RangeMapScore dark =
      score_range_map(wall.measured, wall.truth, PixelMask::Constant(2, 5, false));
  EXPECT_TRUE(std::isnan(dark.coverage));
  EXPECT_EQ(dark.error.count, 6);
  EXPECT_TRUE(std::isnan(score_range_map(wall.measured, nothing).distance));
}

TEST(RangeMapScore, RefusesImagesOfDifferentSize) {
  const ImageF map = ImageF::Constant(2, 3, 700);
  EXPECT_THROW((void)score_range_map(map, ImageF::Constant(3, 2, 700)), InvalidInput);
  EXPECT_THROW((void)score_range_map(map, map, PixelMask::Constant(3, 2, true)), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
