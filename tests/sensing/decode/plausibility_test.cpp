// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/plausibility.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

constexpr double kMinAgreement = 0.8;

Mask eroded(const Mask& mask, int radius) {
  Mask inner;
  erode(mask, radius, inner);
  return inner;
}

TEST(Plausibility, ErosionTakesItsRadiusAllAroundButNotAtTheImageBorder) {
  Mask mask = Mask::Zero(8, 9);
  mask.block(2, 0, 4, 5) = 1;
  Mask expected = Mask::Zero(8, 9);
  expected.block(3, 0, 2, 4) = 1;
  EXPECT_TRUE((eroded(mask, 1) == expected).all());
  EXPECT_TRUE((eroded(mask, 2) == 0).all());
  EXPECT_TRUE((eroded(mask, 0) == mask).all());
  EXPECT_TRUE((eroded(Mask::Ones(8, 9), 4) == 1).all());
}

TEST(Plausibility, ErodingTwiceIsErodingByBothRadii) {
  std::mt19937 random(5);
  Mask mask(40, 50);
  for (long i = 0; i < mask.size(); ++i) mask.data()[i] = random() % 50 == 0 ? 0 : 1;
  EXPECT_TRUE((eroded(eroded(mask, 1), 2) == eroded(mask, 3)).all());
  EXPECT_GT((eroded(mask, 3) != 0).count(), 0);
}

Mask breaks_of(const Plane& phase, double max_step) {
  Mask marked;
  find_breaks(phase, max_step, {.rows = 3, .columns = 2}, marked);
  return marked;
}

TEST(Plausibility, GapsAreBridgedWhereTheSurfaceGoesOn) {
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  Mask mask = Mask::Ones(5, 10);
  mask.block(0, 4, 5, 2) = 0;
  mask.row(3).segment(3, 4) = 0;
  mask.row(4).setZero();
  mask.row(4).segment(4, 3) = 1;
  Plane phase = Plane::Constant(5, 10, 1);
  phase.row(1).tail(4) = 4;  // another surface
  phase(2, 6) = kUnknown;
  Mask bridged;
  bridge_gaps(mask, phase, 2, 2, bridged);
  Mask expected = mask;
  expected.row(0) = 1;
  EXPECT_TRUE((bridged == expected).all());
  bridge_gaps(mask, phase, 4, 3.5, bridged);
  expected.row(1) = expected.row(3) = 1;
  EXPECT_TRUE((bridged == expected).all());
}

TEST(Plausibility, ABreakReachesAsFarAsTheWindowMixes) {
  Plane phase = Plane::Zero(12, 20);
  phase.rightCols(10) = 3;
  const Mask marked = breaks_of(phase, 2);
  for (long column = 0; column < 20; ++column) {
    EXPECT_EQ(marked(6, column) != 0, column >= 7 && column <= 11) << column;
  }
  Plane stairs = Plane::Zero(12, 20);
  stairs.bottomRows(6) = -3;
  const Mask across = breaks_of(stairs, 2);
  for (const long column : {10L, 19L}) {
    for (long row = 0; row < 12; ++row) {
      EXPECT_EQ(across(row, column) != 0, row >= 2 && row <= 8) << row;
    }
  }
  EXPECT_TRUE((breaks_of(phase, 3.1) == 0).all());
  phase.middleCols(9, 1) = std::nanf("");
  EXPECT_TRUE((breaks_of(phase, 2) == 0).all());
}

TEST(Plausibility, AStepIsFoundAcrossPixelsWithoutAPhase) {
  Plane phase = Plane::Zero(40, 30);
  phase.bottomRows(20) = 5;
  phase.middleRows(16, 8) = std::nanf("");
  Mask marked;
  const auto find = [&](int rows) {
    find_steps(phase, {.step = 2, .slope = 0.2, .gap = {rows, 4}}, {.rows = 3, .columns = 2},
               marked);
  };
  find(9);
  for (long row = 0; row < 40; ++row) {
    const bool above = row >= 12 && row <= 18, below = row >= 21 && row <= 27;
    EXPECT_EQ(marked(row, 7) != 0, above || below) << row;
  }
  find(8);  // the two sides are 9 px apart
  EXPECT_TRUE((marked == 0).all());
  phase.bottomRows(20) *= 0.7F;  // 3.5 rad over 9 px: a slope may do that
  find(9);
  EXPECT_TRUE((marked == 0).all());
}

TEST(Plausibility, OnlyMarksAboveTheLimitAreKept) {
  Plane values(1, 4);
  values << 0.1F, 0.3F, std::nanf(""), 0.5F;
  Mask marked(1, 4);
  marked << 1, 1, 1, 0;
  keep_above(values, 0.2, marked);
  EXPECT_EQ(marked(0, 0) + marked(0, 2) + marked(0, 3), 0);
  EXPECT_EQ(marked(0, 1), 1);
}

class Contradictions : public ::testing::Test {
 protected:
  /// Hues and projector pixels of a wall that shows stripes of 33 px, seen one to one.
  Contradictions() : hue_(60, 200), pixel_(60, 200) {
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
    constexpr long kNearby = 16;  // px
    Mask marked;
    ColorSays says;
    compare_colors(pixel_, hue_, StripeColors(pattern_), classifier_, says);
    find_contradictions(pixel_, says, kMinAgreement, kNearby, marked);
    return marked;
  }
  Pattern pattern_ = make_pattern(Axis::y, 10, 1024);
  HueClassifier classifier_{pattern_, ideal_colors()};
  Plane hue_;
  Plane pixel_;
};

TEST_F(Contradictions, TheRightDepthsAgree) { EXPECT_TRUE((contradicting() == 0).all()); }

TEST_F(Contradictions, DepthsThatAreOnePeriodOffAreFoundOut) {
  pixel_ += 10;
  EXPECT_GT((contradicting() != 0).count(), 0.6 * 60 * 200);
}

TEST_F(Contradictions, AreCountedInTheSquareAroundEachPixel) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> pixels(80, 900);
  std::uniform_real_distribution<float> hues(0, 2 * std::numbers::pi_v<float>);
  for (long i = 0; i < pixel_.size(); ++i) {
    if (random() % 3 == 0) pixel_.data()[i] = pixels(random);
    if (random() % 3 == 0) pixel_.data()[i] = std::nanf("");
    if (random() % 30 == 0) hue_.data()[i] = hues(random);
  }
  const StripeColors stripes(pattern_);
  const Mask marked = contradicting();
  EXPECT_GT((marked != 0).count(), 100);
  for (long row = 0; row < 60; row += 7) {
    for (long column = 0; column < 200; column += 3) {
      int compared = 0;
      int agreeing = 0;
      for (long r = std::max(0L, row - 16); r <= std::min(59L, row + 16); ++r) {
        for (long c = std::max(0L, column - 16); c <= std::min(199L, column + 16); ++c) {
          if (std::isnan(pixel_(r, c)) || stripes.color(pixel_(r, c)) < 0) continue;
          ++compared;
          if (stripes.color(pixel_(r, c)) == classifier_.best(hue_(r, c))) ++agreeing;
        }
      }
      const bool wrong = !std::isnan(pixel_(row, column)) && agreeing < kMinAgreement * compared;
      EXPECT_EQ(marked(row, column) != 0, wrong) << row << ' ' << column;
    }
  }
}

TEST(StripeColors, AreThoseOfThePatternButNotNearEdges) {
  const Pattern pattern = make_pattern(Axis::y, 10, 1024);  // edges every 33.03 px from 32.5
  const StripeColors stripes(pattern);
  EXPECT_EQ(stripes.color(-100), pattern.stripes[0]);
  EXPECT_EQ(stripes.color(28), pattern.stripes[0]);
  EXPECT_EQ(stripes.color(29), -1);
  EXPECT_EQ(stripes.color(36), -1);
  EXPECT_EQ(stripes.color(37), pattern.stripes[1]);
  EXPECT_EQ(stripes.color(1000), pattern.stripes[30]);
  EXPECT_EQ(stripes.color(1e9F), pattern.stripes[30]);
}

TEST_F(Contradictions, UnknownPixelsAreNotJudged) {
  pixel_ += 10;
  pixel_.leftCols(100) = std::nanf("");
  EXPECT_TRUE((contradicting().leftCols(100) == 0).all());
}

}  // namespace
}  // namespace palpate::sensing
