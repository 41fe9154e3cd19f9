// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/trade_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace palpate::apps {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(TradePlot, FindsThePointsThatNoOtherOneBeats) {
  EXPECT_THAT(pareto_front({{"a", 5, 1}, {"b", 1, 5}, {"c", 3, 3}, {"d", 4, 3}, {"e", 3, 4}}),
              ElementsAre(1, 2, 0));
  EXPECT_THAT(pareto_front({{"twice", 2, 2}, {"twice", 2, 2}}), ElementsAre(0));
  EXPECT_TRUE(pareto_front({}).empty());
}

TEST(TradePlot, AgreesWithComparingAllPairs) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> small(1, 12);  // ties
  std::vector<TradeDot> dots;
  for (int i = 0; i < 60; ++i) {
    const double cost = small(random);
    dots.push_back({"", cost, static_cast<double>(small(random))});
  }
  const std::vector<std::size_t> front = pareto_front(dots);
  for (std::size_t i = 0; i < dots.size(); ++i) {
    bool is_beaten = false;
    for (std::size_t j = 0; j < dots.size(); ++j) {
      const bool no_worse = dots[j].cost <= dots[i].cost && dots[j].error <= dots[i].error;
      const bool is_better = dots[j].cost < dots[i].cost || dots[j].error < dots[i].error || j < i;
      is_beaten = is_beaten || (no_worse && is_better);
    }
    EXPECT_EQ(std::ranges::find(front, i) == front.end(), is_beaten) << i;
  }
}

TEST(TradePlot, DrawsEachPointWithItsName) {
  const std::string svg = trade_svg({{"a < b", 10, 0.5}, {"c", 1000, 0}}, "size [kB]", "error [N]");
  EXPECT_THAT(svg, HasSubstr("<title>a &lt; b</title>"));
  EXPECT_THAT(svg, HasSubstr(">size [kB]</text>"));
  for (const std::vector<TradeDot>& dots :
       {std::vector<TradeDot>{}, {{"one", 1, 0}}, {{"same", 2, 3}, {"same", 2, 3}}})
    EXPECT_THAT(trade_svg(dots, "cost", "error"), Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace palpate::apps
