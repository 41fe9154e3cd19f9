// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/scene_world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "not_finite.h"
#include "palpate/haptics/device_run.h"
#include "palpate/haptics/rotation.h"
#include "palpate/haptics/simulated_hand.h"
#include "playback/allocation_counter.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

std::shared_ptr<const Scene> sheets(int count, const SceneOptions& options = {}) {
  static const auto sheet = std::make_shared<const Playback>(sheet_model());
  std::vector<SceneObject> objects;
  for (int i = 0; i < count; ++i) objects.push_back({"sheet " + std::to_string(i), sheet});
  return std::make_shared<const Scene>(std::move(objects), options);
}

/// A path of an object that is 8 mm along -z after 0.4 s, and stays.
PosePath rising() {
  PosePoint begin, end{.time = 0.4};
  end.T_world_object.translation().z() = -8;
  return PosePath({begin, end});
}
PosePath at_rest() { return PosePath({PosePoint{}}); }
TimedPath standing(const Vector3d& place) { return TimedPath({{0, place}}); }

/// From above, 8 mm into the sheet, along it, and back.
TimedPath touches() {
  return TimedPath({{0, {3, 4, 695}},
                    {0.3, {3, 4, 708}},
                    {0.6, {15, -6, 708}},
                    {0.8, {15, -6, 708}},
                    {1, {15, -6, 694}}},
                   PathShape::smooth);
}

devices::DeviceDescription strong_device() {
  return {.name = "some", .highest_force = 10, .continuous_force = 10};
}

TickInput input_of_tick(int tick, const Vector3d& tip) {
  TickInput input{.now = 5 + 1e-3 * tick};
  input.state.tip = tip;
  input.state.time = input.now;
  return input;
}

// The loop with one model, which has its own tests.
TEST(SceneWorld, OneObjectAtRestFeelsBitByBitLikeItsModel) {
  const std::shared_ptr<const Scene> scene = sheets(1);
  SceneWorld world(scene, {.objects = {at_rest()}, .tools = {standing({0, 0, 0})}}, 0);
  const Playback& model = *scene->objects()[0].playback;
  DeviceLoop in_scene(strong_device()), alone(strong_device());
  int touching = 0;
  for (int tick = 0; tick < 1200; ++tick) {
    const TickInput input = input_of_tick(tick, touches().position(1e-3 * tick));
    const TickOutput felt = in_scene.tick(world, input), expected = alone.tick(model, input);
    ASSERT_EQ(felt.command.force, expected.command.force) << tick;
    ASSERT_EQ(felt.tool, expected.tool);
    ASSERT_EQ(felt.contact, expected.contact);
    ASSERT_EQ(felt.state, expected.state);
    touching += felt.state != ContactState::free;
  }
  EXPECT_GT(touching, 500);
}

// The tool is at 697, the sheet rises from 700 to 692: 4 d / sqrt(d^2 + 100) with d = 5.
TEST(SceneWorld, AnObjectThatMovesPressesADeviceAtRest) {
  SceneWorld world(sheets(1), {.objects = {rising()}, .tools = {standing({0, 0, 0})}}, 0);
  DeviceLoop loop(strong_device(), {.coupling = {.on = false}});
  TickOutput output;
  for (int tick = 0; tick < 700; ++tick) {
    output = loop.tick(world, input_of_tick(tick, {3, 4, 697}));
    if (tick == 100) {
      EXPECT_TRUE(output.command.force.isZero(0)) << "the sheet is at 698";
    }
  }
  EXPECT_EQ(output.state, ContactState::stick);
  EXPECT_LT((output.command.force - Vector3d(0, 0, -20 / std::sqrt(125.0))).norm(), 1e-9);
  EXPECT_LT((output.contact - Vector3d(3, 4, 692)).norm(), 1e-6);
  EXPECT_LT((world.command().objects[0].force + output.command.force).norm(), 1e-9);
}

TEST(SceneWorld, OtherToolsGoTheirWaysAsWithoutADevice) {
  const std::shared_ptr<const Scene> scene = sheets(2);
  PosePoint beside;
  beside.T_world_object.translation().x() = 1000;
  std::vector<TrajectoryPoint> path;
  for (int i = 0; i <= 100; ++i) {
    path.push_back({0.01 * i, touches().position(0.01 * i) + Vector3d(1000, 0, 0)});
  }
  const SceneMotion motion{.objects = {at_rest(), PosePath({beside})},
                           .tools = {standing({0, 0, 600}), TimedPath(path)}};
  const SceneTrace without = play(*scene, motion);
  SceneWorld world(scene, motion, 0);
  DeviceLoop loop(strong_device());
  for (int tick = 0; tick < 1000; ++tick) {
    static_cast<void>(loop.tick(world, input_of_tick(tick, touches().position(1e-3 * tick))));
    const SceneTracePoint& expected = without.tools[1][static_cast<std::size_t>(tick)];
    const ToolCommand& felt = world.command().tools[1];
    // The device's clock began at 5 s: times differ by rounding.
    ASSERT_LT((felt.command.force - expected.felt.force).norm(), 1e-9) << tick;
    ASSERT_EQ(felt.object, expected.object);
  }
}

// Without an answer the tool stands still, and the sheet still comes: there is no force before the
// answer, then the ramp, then that of the place.
TEST(SceneWorld, AnObjectRunsIntoAToolOfWhichNothingIsKnown) {
  for (const bool answered : {false, true}) {
    SceneWorld world(sheets(1), {.objects = {rising()}, .tools = {standing({0, 0, 0})}}, 0);
    DeviceLoop loop(strong_device(), {.coupling = {.on = false}});
    double before = -1;
    TickOutput output;
    for (int tick = 0; tick < 1500; ++tick) {
      TickInput input = input_of_tick(tick, {3, 4, 697});
      if (tick >= 50 && tick < 600) {
        input.answered = answered;
        if (answered) input.state.tip.setConstant(kNaN);
      }
      output = loop.tick(world, input);
      ASSERT_TRUE(output.command.force.allFinite());
      if (tick != 599) continue;
      before = output.command.force.norm();
      EXPECT_NEAR(world.command().objects[0].force.norm(), 20 / std::sqrt(125.0), 1e-9);
    }
    EXPECT_EQ(before, 0);
    EXPECT_LT((output.command.force - Vector3d(0, 0, -20 / std::sqrt(125.0))).norm(), 1e-9);
  }
}

TEST(SceneWorld, DoesNotAllocateInTheLoop) {
  if (!test::counts_allocations()) GTEST_SKIP() << "the sanitizer's allocator cannot be counted";
  PosePoint begin, end{.time = 1};
  end.T_world_object.linear() = rotation_exp({0, 0, 0.5});
  const SceneMotion motion{.objects = {PosePath({begin, end}), rising()},
                           .tools = {standing({0, 0, 0}), touches()}};
  SceneWorld world(sheets(2, {.closest_tools = 40}), motion, 0);
  DeviceLoop loop(strong_device());
  std::vector<TickInput> inputs;
  for (int tick = 0; tick < 1000; ++tick) {
    inputs.push_back(input_of_tick(tick, touches().position(1e-3 * tick) + Vector3d(9, 0, 0)));
    inputs.back().answered = tick % 50 != 7;
  }
  int touching = 0, near = 0;
  const long before = test::allocations();
  for (const TickInput& input : inputs) {
    const TickOutput output = loop.tick(world, input);
    touching += output.state != ContactState::free;
    near += world.command().tools[0].share < 1 || world.command().tools[1].share < 1;
  }
  EXPECT_EQ(test::allocations(), before);
  EXPECT_GT(touching, 500);
  EXPECT_GT(near, 100);
}

TEST(SceneWorld, ASessionIsReplayedToTheBitAndGivesTheTracesOfAll) {
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch / "s.bin";
  const std::shared_ptr<const Scene> scene = sheets(2);
  PosePoint beside;
  beside.T_world_object.translation().x() = 1000;
  const SceneMotion motion{
      .objects = {rising(), PosePath({beside})},
      .tools = {standing({1003, 4, 705}), standing({0, 0, 0}), standing({30, -20, 697})}};
  const auto world_of = [&](std::size_t tool) {
    return std::make_shared<SceneWorld>(scene, motion, tool);
  };
  SimulatedHand hand(touches());
  const RunReport report =
      DeviceRun(hand, world_of(1), {},
                {.duration = 1, .real_time = false, .record = file, .session = "a scene"})
          .finish();
  EXPECT_GT(report.states[1] + report.states[2], 500);
  const LoopRecord record = read_loop_record(file);
  const LoopReplay again = replay(record, *world_of(1));
  EXPECT_EQ(again.ticks, report.time.ticks);
  EXPECT_EQ(again.different, 0);
  SceneMotion other = motion;
  other.objects[0] = at_rest();
  SceneWorld resting(scene, other, 1);
  EXPECT_GT(replay(record, resting).different, 100) << "in another scene all is different";

  const SceneTrace trace = trace_of(record, *world_of(1));
  ASSERT_EQ(trace.tools.size(), 3u);
  ASSERT_EQ(trace.objects.size(), 2u);
  const std::vector<TracePoint> felt = trace_of(record);
  ASSERT_EQ(trace.tools[1].size(), felt.size());
  for (std::size_t i = 0; i < felt.size(); ++i) {
    ASSERT_EQ(trace.tools[1][i].felt.force, felt[i].force);
    ASSERT_EQ(trace.tools[1][i].felt.contact, felt[i].contact);
  }
  EXPECT_EQ(trace.tools[0].back().object, 1);
  EXPECT_LT((trace.tools[0].back().felt.force - Vector3d(0, 0, -20 / std::sqrt(125.0))).norm(),
            1e-9);
  EXPECT_EQ(trace.tools[2].back().object, 0);
}

TEST(SceneWorld, RefusesWhatDoesNotFit) {
  const SceneMotion motion{.objects = {at_rest()}, .tools = {standing({0, 0, 0})}};
  EXPECT_THAT(refusal([&] { SceneWorld(nullptr, motion, 0); }), HasSubstr("there is no scene"));
  EXPECT_THAT(refusal([&] { SceneWorld(sheets(2), motion, 0); }),
              HasSubstr("ways of 1 objects; the scene has 2"));
  EXPECT_THAT(refusal([&] { SceneWorld(sheets(1), motion, 1); }),
              HasSubstr("the device has tool 1; there are 1, from 0"));
  SimulatedHand hand(touches());
  const auto world = std::make_shared<SceneWorld>(sheets(1), motion, 0);
  const std::vector<ModelExchange> exchanges{{0.5, sheets(1)->objects()[0].playback}};
  EXPECT_THAT(refusal([&] {
                DeviceRun(hand, world, {},
                          {.duration = 1, .real_time = false, .exchanges = exchanges});
              }),
              HasSubstr("RunOptions::exchanges: the models of a world cannot be exchanged"));
}

}  // namespace
}  // namespace palpate::haptics
