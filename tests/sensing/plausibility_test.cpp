// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "plausibility.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

TEST(Plausibility, ErosionTakesOnePixelAllAroundButNotAtTheImageBorder) {
  Mask mask = Mask::Zero(8, 9);
  mask.block(2, 0, 4, 5) = 1;
  Mask expected = Mask::Zero(8, 9);
  expected.block(3, 0, 2, 4) = 1;
  EXPECT_TRUE((eroded(mask) == expected).all());
  EXPECT_TRUE((eroded(Mask::Ones(8, 9)) == 1).all());
}

TEST(Plausibility, ABreakReachesAsFarAsTheWindowMixes) {
  Plane phase = Plane::Zero(12, 20);
  phase.rightCols(10) = 3;
  const Mask marked = near_breaks(phase, Mask::Ones(12, 20), 2, {.rows = 3, .columns = 2});
  for (long column = 0; column < 20; ++column) {
    EXPECT_EQ(marked(6, column) != 0, column >= 7 && column <= 11) << column;
  }
  Plane stairs = Plane::Zero(12, 20);
  stairs.bottomRows(6) = -3;
  const Mask across = near_breaks(stairs, Mask::Ones(12, 20), 2, {.rows = 3, .columns = 2});
  for (long row = 0; row < 12; ++row) {
    EXPECT_EQ(across(row, 10) != 0, row >= 2 && row <= 8) << row;
  }
  EXPECT_TRUE((near_breaks(phase, Mask::Ones(12, 20), 3.1, {.rows = 3, .columns = 2}) == 0).all());
  Mask known = Mask::Ones(12, 20);
  known.middleCols(9, 1) = 0;
  EXPECT_TRUE((near_breaks(phase, known, 2, {.rows = 3, .columns = 2}) == 0).all());
}

class StripeColors : public testing::Test {
 protected:
  /// Hues and projector pixels of a wall that shows stripes of 33 px, seen one to one.
  StripeColors() : hue_(60, 200), pixel_(60, 200) {
    for (long column = 0; column < 200; ++column) {
      const double pixel = 100.0 + static_cast<double>(column);
      std::size_t stripe = 0;
      while (pixel > pattern_.stripe_edges[stripe]) ++stripe;
      hue_.col(column) =
          std::numbers::pi_v<float> / 3 * static_cast<float>(pattern_.stripes[stripe]);
      pixel_.col(column) = static_cast<float>(pixel);
    }
  }
  Mask contradicting() const {
    return contradicting_colors(pixel_, hue_, pattern_, classifier_, 0.8);
  }
  Pattern pattern_ = make_pattern(Axis::y, 10, 1024);
  HueClassifier classifier_{pattern_, ideal_colors()};
  Plane hue_;
  Plane pixel_;
};

TEST_F(StripeColors, TheRightDepthsAgree) { EXPECT_TRUE((contradicting() == 0).all()); }

TEST_F(StripeColors, DepthsThatAreOnePeriodOffAreFoundOut) {
  pixel_ += 10;
  EXPECT_GT((contradicting() != 0).count(), 0.6 * 60 * 200);
}

TEST_F(StripeColors, UnknownPixelsAreNotJudged) {
  pixel_ += 10;
  pixel_.leftCols(100) = std::nanf("");
  EXPECT_TRUE((contradicting().leftCols(100) == 0).all());
}

}  // namespace
}  // namespace palpate::sensing
