// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/stripe_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

using Pairs = std::set<std::pair<int, int>>;
using ::testing::HasSubstr;

/// The ordered pairs of neighbours; empty if one is no pair or appears twice.
Pairs transitions(const std::vector<int>& sequence) {
  Pairs pairs;
  for (std::size_t i = 1; i < sequence.size(); ++i) {
    const bool differ = sequence[i - 1] != sequence[i];
    if (!differ || !pairs.insert({sequence[i - 1], sequence[i]}).second) return {};
  }
  return pairs;
}

/// As of hues around a circle.
Eigen::MatrixXd circular_separation(int colors) {
  Eigen::MatrixXd separation(colors, colors);
  for (int a = 0; a < colors; ++a) {
    for (int b = 0; b < colors; ++b) {
      const int distance = std::abs(a - b);
      separation(a, b) = std::min(distance, colors - distance);
    }
  }
  return separation;
}

TEST(StripeSequence, HasEveryOrderedPairOnceWhenItIsTheLongest) {
  for (int colors = 2; colors <= 8; ++colors) {
    const std::vector<int> sequence = stripe_sequence(circular_separation(colors));
    EXPECT_EQ(static_cast<int>(sequence.size()), colors * (colors - 1) + 1);
    EXPECT_EQ(static_cast<int>(transitions(sequence).size()), colors * (colors - 1));
    EXPECT_EQ(sequence.front(), 0);
    EXPECT_GE(*std::min_element(sequence.begin(), sequence.end()), 0);
    EXPECT_LT(*std::max_element(sequence.begin(), sequence.end()), colors);
  }
  EXPECT_EQ(longest_stripe_sequence(6), 31);
}

TEST(StripeSequence, HasNoPairTwiceAtAnyLength) {
  for (int colors = 2; colors <= 8; ++colors) {
    for (int stripes = 2; stripes <= longest_stripe_sequence(colors); ++stripes) {
      const std::vector<int> sequence = stripe_sequence(circular_separation(colors), stripes);
      ASSERT_EQ(static_cast<int>(sequence.size()), stripes);
      EXPECT_EQ(static_cast<int>(transitions(sequence).size()), stripes - 1)
          << colors << " colours, " << stripes << " stripes";
    }
  }
}

TEST(StripeSequence, UsesThePairsThatAreEasiestToTellApart) {
  // Six hues have 3 pairs at 180 degrees, 6 at 120 and 6 at 60. The opposite pairs and those at 120
  // degrees reach all colours: 9 pairs, 18 transitions, none between neighbouring hues.
  const Eigen::MatrixXd separation = circular_separation(6);
  for (const auto& [a, b] : transitions(stripe_sequence(separation, 19))) {
    EXPECT_GE(separation(a, b), 2) << a << " " << b;
  }
}

TEST(StripeSequence, ReachesEveryColourWhereTwoTransitionsAColourAreAllowed) {
  // One colour that is like all others: it occurs only because it must be reached.
  Eigen::MatrixXd separation = Eigen::MatrixXd::Constant(5, 5, 3.0);
  separation.row(4).setConstant(0.1);
  separation.col(4).setConstant(0.1);
  const std::vector<int> sequence = stripe_sequence(separation, 9);
  EXPECT_EQ(std::set<int>(sequence.begin(), sequence.end()).size(), 5U);
}

TEST(StripeSequence, RefusesWrongInputAndSaysWhatWouldBeRight) {
  const Eigen::MatrixXd good = circular_separation(3);
  const auto refusal_of = [](const Eigen::MatrixXd& separation, int stripes) {
    return message_of<InvalidInput>([&] { (void)stripe_sequence(separation, stripes); });
  };
  EXPECT_THAT(refusal_of(good, 8), HasSubstr("2 to 7"));
  EXPECT_THAT(refusal_of(good, 1), HasSubstr("2 to 7"));
  EXPECT_THAT(refusal_of(good, -3), HasSubstr("2 to 7"));
  EXPECT_THAT(refusal_of(good.topRows(2), 0), HasSubstr("2 x 3"));
  EXPECT_THAT(refusal_of(good.topLeftCorner(1, 1), 0), HasSubstr("at least 2"));
  Eigen::MatrixXd bad = good;
  bad(0, 1) = 2;
  EXPECT_THAT(refusal_of(bad, 0), HasSubstr("symmetric"));
  bad = good;
  bad(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal_of(bad, 0), HasSubstr("NaN"));
}

}  // namespace
}  // namespace palpate::sensing
