// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "tick_player.h"

#include <gtest/gtest.h>

namespace palpate::view {
namespace {

constexpr std::size_t kAll = 1000;  // ticks: more than are played

/// 100 ticks whose times are their numbers.
TickPlayer player_of_hundred() {
  std::vector<FeltTick> ticks(100);
  for (std::size_t i = 0; i < ticks.size(); ++i) ticks[i].time = static_cast<double>(i);
  return TickPlayer(std::move(ticks));
}

TEST(TickPlayer, GivesEachTickOnceInItsOrder) {
  TickPlayer player = player_of_hundred();
  int next = 0;
  for (int frame = 0; frame < 8; ++frame) {
    player.advance(0.017);
    for (const FeltTick& tick : player.take(kAll).ticks) EXPECT_EQ(tick.time, next++);
  }
  EXPECT_EQ(next, 100);
  EXPECT_FALSE(player.is_playing()) << "at the end";
  EXPECT_EQ(player.time(), player.duration());
}

TEST(TickPlayer, StandsStillWhileItIsPaused) {
  TickPlayer player = player_of_hundred();
  player.advance(0.02);
  player.toggle();
  player.advance(0.05);
  EXPECT_NEAR(player.time(), 0.02, 1e-12);
  player.toggle();
  player.advance(0.01);
  EXPECT_NEAR(player.time(), 0.03, 1e-12);
}

TEST(TickPlayer, BeginsAnewWhenTimeGoesBack) {
  TickPlayer player = player_of_hundred();
  player.advance(0.08);
  EXPECT_FALSE(player.take(kAll).anew);
  player.seek(0.03);
  const TickPlayer::Part part = player.take(10);
  EXPECT_TRUE(part.anew);
  ASSERT_EQ(part.ticks.size(), 10u) << "what came before, as far as it is wanted";
  EXPECT_EQ(part.ticks.front().time, 20);
  EXPECT_EQ(part.ticks.back().time, 29);
  player.seek(-1);
  EXPECT_EQ(player.time(), 0);
  player.seek(9);
  EXPECT_EQ(player.take(5).ticks.back().time, 99);
}

TEST(TickPlayer, PlaysAgainFromTheBeginningWhenItWasAtTheEnd) {
  TickPlayer player = player_of_hundred();
  player.advance(1);
  player.toggle();
  EXPECT_TRUE(player.is_playing());
  EXPECT_EQ(player.time(), 0);
}

}  // namespace
}  // namespace palpate::view
