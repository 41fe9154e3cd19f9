// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "ticks.h"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::pictures {
namespace {

/// Rounding of a few operations on the tick's own size.
constexpr double kRounding = 1e-12;

TEST(Ticks, RoundLengthsDownToOneTwoFive) {
  EXPECT_DOUBLE_EQ(round_down(0.7), 0.5);
  EXPECT_DOUBLE_EQ(round_down(4.99), 2);
  EXPECT_DOUBLE_EQ(round_down(19.9), 10);
  EXPECT_DOUBLE_EQ(round_down(200), 200);
}

TEST(Ticks, AreMultiplesOfARoundStepWithinTheScale) {
  for (const double low : {-1234.5, -0.013, 0.0, 0.31, 641.4}) {
    for (const double length : {1e-4, 0.7, 3.09, 188.6, 5e4}) {
      for (const int most : {2, 5, 9}) {
        const Ticks ticks = make_ticks(low, low + length, most);
        EXPECT_LE(ticks.values.size(), static_cast<std::size_t>(most));
        EXPECT_NEAR(round_down(ticks.step * (1 + kRounding)), ticks.step, kRounding * ticks.step);
        ASSERT_EQ(ticks.labels.size(), ticks.values.size());
        for (const double value : ticks.values) {
          const double slack = kRounding * (std::abs(low) + length);
          EXPECT_GE(value, low - slack - 1e-9 * ticks.step);
          EXPECT_LE(value, low + length + slack + 1e-9 * ticks.step);
          EXPECT_NEAR(std::remainder(value, ticks.step), 0, slack);
        }
      }
    }
  }
}

TEST(Ticks, FillTheScale) {
  const Ticks ticks = make_ticks(0, 10, 9);
  EXPECT_EQ(ticks.labels, (std::vector<std::string>{"0", "2", "4", "6", "8", "10"}));
}

TEST(Ticks, HaveOneNumberOfDecimalsAndNoNegativeZero) {
  const Ticks ticks = make_ticks(-0.3, 0.3, 7);
  EXPECT_EQ(ticks.labels,
            (std::vector<std::string>{"-0.3", "-0.2", "-0.1", "0.0", "0.1", "0.2", "0.3"}));
}

TEST(Ticks, WriteHugeNumbersWithPowersOfTen) { EXPECT_EQ(format_value(3e7, 1e6), "3e+07"); }

}  // namespace
}  // namespace palpate::pictures
