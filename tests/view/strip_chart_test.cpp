// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "strip_chart.h"

#include <gtest/gtest.h>

namespace palpate::view {
namespace {

using haptics::ContactState;
constexpr int kColumns = 50;  // of 100 ticks each

void add(StripChart& chart, int ticks, double total, ContactState state) {
  ForceReading reading;
  reading.total = total;
  reading.normal = total / 2;
  for (int i = 0; i < ticks; ++i) chart.add(reading, state);
}

TEST(StripChart, ShowsTheLatestTicksOnTheRight) {
  StripChart chart(1);
  EXPECT_TRUE(chart.is_empty());
  add(chart, 100, 0.5, ContactState::stick);
  add(chart, 100, 0.25, ContactState::slip);
  EXPECT_FALSE(chart.is_empty());
  const auto total = chart.columns(StripChart::Line::total, kColumns);
  const auto states = chart.states(kColumns);
  EXPECT_EQ(total[kColumns - 2].high, 0.5F);
  EXPECT_EQ(states[kColumns - 2], ContactState::stick);
  EXPECT_EQ(total[kColumns - 1].low, 0.25F);
  EXPECT_EQ(states[kColumns - 1], ContactState::slip);
  EXPECT_EQ(total[kColumns - 3].high, 0);
  EXPECT_EQ(states[kColumns - 3], ContactState::free);
  EXPECT_EQ(chart.columns(StripChart::Line::normal, kColumns).back().high, 0.125F);
}

TEST(StripChart, DoesNotLoseAPeakOfOneTick) {
  StripChart chart(1);
  add(chart, 40, 0.5, ContactState::stick);
  add(chart, 1, 3, ContactState::stick);
  add(chart, 59, 0.5, ContactState::stick);
  const StripChart::Column last = chart.columns(StripChart::Line::total, kColumns).back();
  EXPECT_EQ(last.low, 0.5F);
  EXPECT_EQ(last.high, 3);
  EXPECT_EQ(chart.top(), 5) << "the next of 1, 2, 5";
}

TEST(StripChart, ForgetsWhatIsOlderThanItsSeconds) {
  StripChart chart(1);
  add(chart, 10, 3, ContactState::stick);
  add(chart, static_cast<int>(StripChart::kCount) - 1, 0, ContactState::free);
  EXPECT_FALSE(chart.is_empty());
  EXPECT_EQ(chart.top(), 5);
  add(chart, 1, 0, ContactState::free);
  EXPECT_TRUE(chart.is_empty());
  EXPECT_EQ(chart.top(), 1);
}

}  // namespace
}  // namespace palpate::view
