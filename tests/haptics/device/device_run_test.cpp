// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/device_run.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "device/hooked_device.h"
#include "device/slow_file.h"
#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/haptics/held_arm.h"
#include "palpate/haptics/loop_record.h"
#include "palpate/haptics/simulated_hand.h"
#include "palpate/haptics/trajectory_device.h"
#include "playback/allocation_counter.h"
#include "refusal.h"
#include "scratch_folder.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using std::chrono::milliseconds;

std::shared_ptr<const Playback> sheet(double weight = 4) {
  Model model = sheet_model();
  for (ContactModel& contact : model.contacts) contact.field = spring(weight, 10);
  return std::make_shared<const Playback>(model);
}

/// From above, 8 mm into the sheet, along it, and back.
TimedPath touches() {
  return TimedPath({{0, {3, 4, 695}},
                    {0.3, {3, 4, 708}},
                    {0.6, {15, -6, 708}},
                    {0.8, {15, -6, 708}},
                    {1, {15, -6, 694}}},
                   PathShape::smooth);
}

TEST(DeviceRun, FeelsTheSheetWithASimulatedHand) {
  SimulatedHand hand(touches());
  DeviceRun run(hand, sheet(), {}, {.duration = 1.2, .real_time = false});
  const RunReport report = run.finish();
  EXPECT_NEAR(static_cast<double>(report.time.ticks), 1200, 1);
  EXPECT_EQ(report.time.late, 0);
  EXPECT_GT(report.states[1] + report.states[2], 500);
  EXPECT_GT(report.states[2], 20);
  EXPECT_GT(report.largest_force, 0.3);
  EXPECT_LT(report.largest_force, 3.3);
  EXPECT_EQ(report.refused, 0);
  EXPECT_NEAR(static_cast<double>(report.actions[0]), 500, 1) << "the ramp";
  EXPECT_GT(report.given.touches, 0);
  // The energy that a spring of 0.28 N/mm (sheet and coupling) gives if it is sampled: K v^2 T t.
  EXPECT_LT(report.given.in_touches, 0.28 * 0.08 * 0.08 * 1200);
  EXPECT_TRUE(report.device_lost.empty());
}

TEST(DeviceRun, TellsHowFarTheToolDisplacedTheContact) {
  // 8 mm straight down into the sheet at z = 700; a hand gives way, and reaches less.
  const auto press = [] {
    return TimedPath({{0, {3, 4, 695}}, {0.3, {3, 4, 708}}, {0.6, {3, 4, 695}}}, PathShape::smooth);
  };
  TrajectoryDevice rigid(press(), {});
  DeviceRun along(rigid, sheet(), {.coupling = {.on = false}},
                  {.duration = 0.6, .real_time = false});
  EXPECT_NEAR(along.finish().largest_displacement, 8, 1e-6);
  SimulatedHand hand(press());
  DeviceRun felt(hand, sheet(), {}, {.duration = 0.6, .real_time = false});
  const double reached = felt.finish().largest_displacement;
  EXPECT_GT(reached, 0.5);
  EXPECT_LT(reached, 7);
}

TEST(DeviceRun, FeelsTheSheetWithAHeldArm) {
  // The arm's y axis points up: the sheet lies below, its outside up.
  DeviceLoopOptions options;
  options.T_world_device.linear() << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  options.T_world_device.translation() << 0, -200, 700;
  HeldArm arm(
      TimedPath({{0, {0, 5, 200}}, {0.4, {0, -8, 200}}, {1, {0, -8, 200}}}, PathShape::smooth));
  DeviceRun run(arm, sheet(), options, {.duration = 1, .real_time = false});
  const RunReport report = run.finish();
  EXPECT_GT(report.states[1], 300);
  EXPECT_GT(report.largest_force, 0.2);
  EXPECT_TRUE(report.device_lost.empty());
}

TEST(DeviceRun, IsReplayedToTheBitWithItsExchange) {
  const ScratchFolder folder;
  SimulatedHand hand(touches());
  const auto first = sheet(), second = sheet(6);
  DeviceRun run(hand, first, {},
                {.duration = 1,
                 .real_time = false,
                 .record = folder / "run.bin",
                 .exchanges = {{0.5, second}}});
  EXPECT_EQ(run.finish().exchanges, 1);
  const LoopRecord record = read_loop_record(folder / "run.bin");
  const LoopReplay again =
      replay(record, std::array<const Playback*, 2>{first.get(), second.get()});
  EXPECT_NEAR(static_cast<double>(again.ticks), 1000, 1);
  EXPECT_EQ(again.different, 0);
}

TEST(DeviceRun, NeitherAllocatesNorReturnsMemoryInItsLoop) {
  if (!test::counts_allocations()) GTEST_SKIP() << "the sanitizer has an allocator of its own";
  const ScratchFolder folder;
  SimulatedHand hand(touches());
  HookedDevice device(hand);
  long begin = 0, end = 0;
  device.after_read = [&](long long number, devices::DeviceState& state) {
    if (number == 20) begin = test::allocations();
    if (number == 980) end = test::allocations();
    if (number % 100 == 50) state.tip.x() = std::numeric_limits<double>::quiet_NaN();
    return number % 150 != 75;
  };
  const auto first = sheet(), second = sheet(6);
  DeviceRun run(device, first, {},
                {.duration = 1.1,
                 .real_time = false,
                 .record = folder / "run.bin",
                 .exchanges = {{0.5, second}}});
  EXPECT_GT(run.finish().states[2], 0);
  EXPECT_GT(begin, 0);
  EXPECT_EQ(end - begin, 0);
}

TEST(DeviceRun, IsNeverFasterThanTheHost) {
  SimulatedHand hand(touches(), {.real_time = true});
  const auto start = std::chrono::steady_clock::now();
  DeviceRun run(hand, sheet(), {}, {.duration = 0.25});
  const RunReport report = run.finish();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  // A loaded machine may make ticks come late, and fewer of them, but none comes early.
  EXPECT_GE(taken.count(), 0.25);
  EXPECT_LE(report.time.rate, 1010);
  EXPECT_GT(report.time.ticks, 20);
  EXPECT_LE(report.time.ticks, 251);
  EXPECT_LE(static_cast<double>(report.time.ticks), 1000 * taken.count() + 1);
}

TEST(DeviceRun, ExchangesTheModelWhileItRuns) {
  const ScratchFolder folder;
  SimulatedHand hand(touches(), {.real_time = true});
  auto first = sheet();
  const std::weak_ptr<const Playback> gone = first;
  DeviceRun run(hand, std::move(first), {}, {.record = folder / "run.bin"});
  std::vector<std::shared_ptr<const Playback>> models;
  for (int i = 0; i < 5; ++i) {
    std::this_thread::sleep_for(milliseconds(40));
    models.push_back(sheet(4 + i));
    run.exchange(models.back());
  }
  EXPECT_TRUE(gone.expired()) << "the loop lets go of it, and this thread frees it";
  run.stop();
  const RunReport report = run.finish();
  EXPECT_EQ(report.exchanges, 5);
  // An exchange fits into a tick of 1 ms. A loaded machine may stop some of them half-way.
  std::vector<double> times;
  for (const TickRecord& tick : read_loop_record(folder / "run.bin").ticks) {
    if ((tick.flags & TickRecord::kExchanged) != 0)
      times.push_back(static_cast<double>(tick.nanoseconds));
  }
  ASSERT_EQ(times.size(), 5U);
  EXPECT_LT(median(times), 1e6);
}

// 50 ms without a tick: the device drops the force by itself, the loop begins again from zero.
TEST(DeviceRun, IsWithoutForceAfterAStall) {
  SimulatedHand hand(touches());
  HookedDevice device(hand);
  bool stalled = false;
  double in_stall = -1;
  std::vector<double> after;
  device.after_read = [&](long long number, devices::DeviceState& state) {
    if (number != 700) return true;
    EXPECT_GT(hand.applied_force().norm(), 0.3);
    for (int i = 0; i < 50; ++i) static_cast<void>(hand.read(state));
    in_stall = hand.applied_force().norm();
    stalled = true;
    return true;
  };
  device.on_write = [&](const devices::DeviceCommand& command) {
    if (stalled) after.push_back(command.force.norm());
  };
  DeviceRun run(device, sheet(), {}, {.duration = 0.8, .real_time = false});
  const RunReport report = run.finish();
  EXPECT_EQ(in_stall, 0);
  ASSERT_GT(after.size(), 20U);
  EXPECT_EQ(after[0], 0);
  EXPECT_LT(after[10], 0.1);
  EXPECT_EQ(report.actions[6], 1) << "late";
  EXPECT_EQ(report.time.late, 1);
}

TEST(DeviceRun, EndsWithTheWordsOfADeviceThatIsLost) {
  SimulatedHand hand(touches());
  HookedDevice device(hand);
  double last = -1;
  device.after_read = [](long long number, devices::DeviceState&) { return number < 500; };
  device.on_write = [&](const devices::DeviceCommand& command) { last = command.force.norm(); };
  DeviceRun run(device, sheet(), {}, {.real_time = false});
  const RunReport report = run.finish();
  EXPECT_EQ(report.device_lost, "it does not answer any more: cable pulled");
  EXPECT_EQ(last, 0);
  EXPECT_EQ(report.time.ticks, 599);
}

// The duration may end before it is sure that the device is lost.
TEST(DeviceRun, TellsADeviceThatIsLostFromOneThatPausesAtTheEnd) {
  for (const bool answers : {true, false}) {
    for (const int failing : {50, 1000}) {
      SimulatedHand hand(touches());
      HookedDevice device(hand);
      const auto fails = [&](long long number) { return number >= 480 && number < 480 + failing; };
      long long reads = 0;
      device.after_read = [&](long long number, devices::DeviceState&) {
        reads = number;
        return answers || !fails(number);
      };
      device.takes = [&](const devices::DeviceCommand&) { return !answers || !fails(reads); };
      DeviceRun run(device, sheet(), {}, {.duration = 0.5, .real_time = false});
      const RunReport report = run.finish();
      EXPECT_EQ(report.refused, answers ? std::min(failing, 100) : 0);
      const std::string lost = answers ? "it takes no commands any more: cable pulled"
                                       : "it does not answer any more: cable pulled";
      EXPECT_EQ(report.device_lost, failing < 100 ? "" : lost);
      EXPECT_NEAR(static_cast<double>(report.time.ticks), 480 + std::min(failing, 100), 1);
    }
  }
}

TEST(DeviceRun, GivesADeviceThatFailsAtOnceTheTimeOfItsTicks) {
  SimulatedHand hand(touches(), {.real_time = true});
  HookedDevice device(hand);
  device.after_read = [&](long long, auto&) { return !(device.unplugged = true); };
  const auto begin = std::chrono::steady_clock::now();
  DeviceRun run(device, sheet(), {}, {.most_unanswered = 60});
  EXPECT_EQ(run.finish().device_lost, "it does not answer any more: cable pulled");
  EXPECT_GE(std::chrono::steady_clock::now() - begin, milliseconds(60));
}

TEST(DeviceRun, LeavesADeviceThatItCannotStartDisarmedAndItsOldRecordAsItWas) {
  const ScratchFolder folder;
  SimulatedHand hand(touches());
  HookedDevice device(hand);
  EXPECT_THROW(DeviceRun(device, sheet(), {}, {.record = folder / "missing" / "run.bin"}),
               OutputError);
  EXPECT_FALSE(device.armed);
  write_text(folder / "run.bin", "an old record");
  device.unplugged = true;
  EXPECT_THROW(DeviceRun(device, sheet(), {}, {.record = folder / "run.bin"}), DeviceError);
  EXPECT_EQ(read_text(folder / "run.bin"), "an old record");
}

// 18,000 ticks are more than the recorder has room for while the disk takes none.
TEST(DeviceRun, WaitsForTheDiskOnlyOffTheHostsClock) {
  const ScratchFolder folder;
  for (const bool real_time : {false, true}) {
    SlowFile file(folder / (real_time ? "loses" : "waits"));
    TrajectoryDevice device(touches());
    DeviceRun run(device, sheet(), {},
                  {.duration = 18, .real_time = real_time, .record = file.path()});
    std::this_thread::sleep_for(milliseconds(200));
    file.take_everything_once([&] { return real_time ? run.done() : true; });
    if (real_time) {
      EXPECT_THROW(static_cast<void>(run.finish()), OutputError);
    } else {
      EXPECT_NEAR(static_cast<double>(run.finish().time.ticks), 18'000, 1);
    }
  }
}

// The figures of a run are not lost with its record.
TEST(DeviceRun, ReportsARunWhoseRecordIsNotComplete) {
  SimulatedHand hand(touches());
  DeviceRun run(hand, sheet(), {}, {.duration = 0.1, .real_time = false, .record = "/dev/full"});
  EXPECT_THROW(static_cast<void>(run.finish()), OutputError);
  EXPECT_GT(run.finish().coupling_stiffness, 0);
}

TEST(DeviceRun, RefusesWhatCannotBe) {
  SimulatedHand hand(touches());
  const auto message = [&](const RunOptions& options) {
    return refusal([&] { return DeviceRun(hand, sheet(), {}, options).done(); });
  };
  EXPECT_NE(message({.duration = -1}).find("RunOptions::duration"), std::string::npos);
  EXPECT_NE(message({.priority = 100}).find("RunOptions::priority"), std::string::npos);
  EXPECT_NE(message({.exchanges = {{1, nullptr}}}).find("each needs a model"), std::string::npos);
  EXPECT_NE(refusal([&] {
              return DeviceRun(hand, std::shared_ptr<const Playback>()).done();
            }).find("there is no model"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::haptics
