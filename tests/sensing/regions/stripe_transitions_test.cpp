// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/stripe_transitions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

constexpr float kSector = std::numbers::pi_v<float> / 3;

/// One scanline: `colors[i]` from column 10 i on.
Plane line_of(const std::vector<int>& colors) {
  Plane hue(1, static_cast<long>(10 * colors.size()));
  for (long column = 0; column < hue.cols(); ++column) {
    hue(0, column) = kSector * static_cast<float>(colors[static_cast<std::size_t>(column / 10)]);
  }
  return hue;
}

std::vector<Transition> find(const Plane& hue, bool reversed = false, const Mask* lit = nullptr,
                             const Pattern& pattern = make_pattern(Axis::y, 10, 1024)) {
  const HueClassifier classifier(pattern, ideal_colors());
  const Mask all = Mask::Ones(hue.rows(), hue.cols());
  std::vector<Transition> found(3);
  find_transitions(
      hue, lit == nullptr ? all : *lit, StripeEdges(pattern), classifier,
      {.min_hue_step = 0.08, .window_px = 5, .min_color_score = 0.7, .reversed = reversed}, found);
  return found;
}

TEST(StripeTransitions, AreFoundAndNamedAlongALine) {
  // The pattern begins R M B R B C: edges 0 ... 4.
  const auto found = find(line_of({0, 5, 4, 0, 4, 3}));
  ASSERT_EQ(found.size(), 5U);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].edge, static_cast<int>(i));
    EXPECT_NEAR(found[i].column, 10 * static_cast<double>(i) + 9.5, 1e-5);
    EXPECT_GT(found[i].score, 1.9F);
  }
}

TEST(StripeTransitions, MirroredStripesAreNamedFromRightToLeft) {
  const auto found = find(line_of({4, 5, 0}), true);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].edge, 1);
  EXPECT_EQ(found[1].edge, 0);
}

TEST(StripeTransitions, ABlurredEdgeIsOneTransitionAndItsMiddleIsNoColour) {
  // From red to green through orange and yellow: one edge (R G is edge 6), not R Y and Y G.
  Plane hue = line_of({0, 2});
  for (long i = 0; i < 4; ++i) hue(0, 8 + i) = kSector * 0.4F * static_cast<float>(i + 1);
  const auto found = find(hue);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].edge, 6);
  EXPECT_NEAR(found[0].column, 9.5, 0.51);
}

TEST(StripeTransitions, ANarrowStripeIsNamedFromWhatThereIsOfIt) {
  Plane hue = line_of({0, 5, 5, 4});
  hue.row(0).segment(10, 17) = 0;  // three pixels of magenta are left
  EXPECT_EQ(find(hue).size(), 2U);
  hue.row(0).segment(27, 1) = 0;  // two are too few
  EXPECT_EQ(find(hue).size(), 0U);
}

TEST(StripeTransitions, UnlitPixelsMakeNoEdge) {
  const Plane hue = line_of({0, 5});
  Mask lit = Mask::Ones(1, 20);
  lit(0, 10) = 0;
  EXPECT_TRUE(find(hue, false, &lit).empty());
}

TEST(StripeTransitions, PairsThatThePatternDoesNotHoldAndUncertainColoursAreDropped) {
  Plane hue = line_of({0, 5});
  hue.row(0).tail(10) = 5.5F * kSector;  // between magenta and red
  EXPECT_TRUE(find(hue).empty());
  Pattern pattern = make_pattern(Axis::y, 10, 1024);
  pattern.stripes = {5, 0};  // only M R
  pattern.stripe_edges = {50};
  EXPECT_TRUE(find(line_of({0, 5}), false, nullptr, pattern).empty());
}

}  // namespace
}  // namespace palpate::sensing
