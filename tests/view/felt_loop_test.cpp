// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "felt_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "live_loop.h"
#include "palpate/haptics/loop_record.h"
#include "scratch_folder.h"
#include "sheet_model.h"

namespace palpate::view {
namespace {

using haptics::ContactState;

std::shared_ptr<const haptics::Playback> playback_of_sheet() {
  return std::make_shared<const haptics::Playback>(haptics::sheet_model());
}

/// Presses the sheet at z = 700, whose outside is towards -z, and slides.
haptics::TimedPath press_and_slide() {
  return haptics::TimedPath(
      {{0, {0, 0, 695}}, {0.2, {0, 0, 703}}, {0.6, {20, 0, 703}}, {0.8, {20, 0, 695}}});
}

/// Expects the contact, force and state of the library's playback of the same tools, bit by bit.
void expect_as_played(const haptics::Playback& playback, const std::vector<FeltTick>& ticks) {
  std::vector<haptics::TrajectoryPoint> tools;
  for (const FeltTick& tick : ticks)
    tools.push_back({kLoopPeriod * static_cast<double>(tools.size()), tick.tool});
  const std::vector<haptics::TracePoint> trace = haptics::play(playback, tools);
  ASSERT_EQ(trace.size(), ticks.size());
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    ASSERT_EQ(ticks[i].contact, trace[i].contact) << "tick " << i;
    ASSERT_EQ(ticks[i].force, trace[i].force) << "tick " << i;
    ASSERT_EQ(ticks[i].state, trace[i].state) << "tick " << i;
  }
}

long count(const std::vector<FeltTick>& ticks, ContactState state) {
  return std::ranges::count_if(ticks, [&](const FeltTick& tick) { return tick.state == state; });
}

TEST(FeltAlong, IsTheTraceOfPlaybackToTheBit) {
  const auto playback = playback_of_sheet();
  const std::vector<FeltTick> ticks = felt_along(playback, press_and_slide());
  EXPECT_EQ(ticks.size(), 801u);
  EXPECT_EQ(ticks.front().tool, Eigen::Vector3d(0, 0, 695));
  EXPECT_GT(count(ticks, ContactState::stick), 50);
  EXPECT_GT(count(ticks, ContactState::slip), 50);
  expect_as_played(*playback, ticks);
}

TEST(FeltAlong, SaysWhatTheSafetyLayerLetsThrough) {
  const auto playback = playback_of_sheet();
  const haptics::TimedPath deep({{0, {0, 0, 695}}, {1, {0, 0, 740}}});
  const std::vector<FeltTick> ticks = felt_along(playback, deep);
  const double limit = devices::SafetyOptions{}.max_force;
  EXPECT_GT(ticks.back().force.norm(), limit);
  EXPECT_NEAR(ticks.back().commanded.norm(), limit, 1e-12);
}

TEST(LiveLoop, FeelsThePressOfAMouseAndRecordsItToTheBit) {
  using namespace std::chrono_literals;
  const ScratchFolder folder;
  const auto playback = playback_of_sheet();
  std::vector<FeltTick> live;
  haptics::RunReport report;
  {
    LiveLoop loop(playback,
                  {.diagonal = 141, .record = folder / "mouse.session", .session = "sheet"});
    ToolWish wish{.presses = 0, .pressed = false, .at = {}, .depth = 4};
    loop.set_wish(wish);
    std::this_thread::sleep_for(20ms);
    wish = {.presses = 1, .pressed = true, .at = {{0, 0, 700}, {0, 0, -1}}, .depth = 4};
    loop.set_wish(wish);
    std::this_thread::sleep_for(150ms);
    wish.at.position = {15, 0, 700};
    loop.set_wish(wish);
    std::this_thread::sleep_for(150ms);
    wish.pressed = false;
    loop.set_wish(wish);
    std::this_thread::sleep_for(250ms);
    report = loop.finish();
    while (const std::optional<FeltTick> tick = loop.take()) live.push_back(*tick);
  }
  ASSERT_EQ(static_cast<long long>(live.size()), report.time.ticks);
  EXPECT_EQ(live.back().state, ContactState::free) << "laid aside again";

  const haptics::LoopRecord record = haptics::read_loop_record(folder / "mouse.session");
  EXPECT_EQ(record.session, "sheet");
  const FeltSession again = felt_again(playback, record);
  EXPECT_EQ(again.replay.different, 0);
  ASSERT_EQ(again.ticks.size(), live.size());
  for (std::size_t i = 0; i < live.size(); ++i) {
    ASSERT_EQ(again.ticks[i].tool, live[i].tool);
    ASSERT_EQ(again.ticks[i].force, live[i].force);
    ASSERT_EQ(again.ticks[i].commanded, live[i].commanded);
    ASSERT_EQ(again.ticks[i].state, live[i].state);
  }
  expect_as_played(*playback, live);
  EXPECT_GT(count(live, ContactState::stick) + count(live, ContactState::slip), 20);
}

TEST(TickFeed, KeepsTheOrderAndLosesWhatIsTooMuchInsteadOfWaiting) {
  TickFeed feed;
  EXPECT_FALSE(feed.take().has_value());
  constexpr int kTooMany = 100'000;
  FeltTick tick;
  for (int i = 0; i < kTooMany; ++i) {
    tick.time = i;
    feed.put(tick);
  }
  int taken = 0;
  while (const std::optional<FeltTick> next = feed.take()) EXPECT_EQ(next->time, taken++);
  EXPECT_GT(taken, 30'000) << "half a minute";
  EXPECT_LT(taken, kTooMany);
  feed.put(tick);
  EXPECT_TRUE(feed.take().has_value()) << "it goes on";
}

}  // namespace
}  // namespace palpate::view
