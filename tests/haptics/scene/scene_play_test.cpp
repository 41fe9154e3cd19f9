// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/scene_play.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "not_finite.h"
#include "palpate/probing/csv.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using ::testing::HasSubstr;

// A tool that rests at 4 mm above the sheet, which rises by 9 mm from 0.2 to 0.3 s.
SceneMotion rising_sheet() {
  PosePoint low{0.2}, high{0.3};
  high.T_world_object.translation() << 0, 0, -9;
  return {.objects = {PosePath({low, high})},
          .tools = {TimedPath({{0.1, {3, 4, 696}}}),
                    TimedPath({{0.15, {0, 0, 500}}, {0.4, {0, 0, 501}}})}};
}

Scene one_sheet() { return Scene({{"sheet", std::make_shared<const Playback>(sheet_model())}}); }

TEST(ScenePlay, SamplesAllWaysOnOneClock) {
  const SceneMotion motion = rising_sheet();
  EXPECT_EQ(tick_count(motion), 301U);  // from 0.1 to 0.4 s
  const SceneInput input = input_at(motion, 150);
  EXPECT_DOUBLE_EQ(input.time, 0.25);
  EXPECT_NEAR(input.poses[0].translation().z(), -4.5, 1e-9);
  EXPECT_EQ(input.tools[0], Eigen::Vector3d(3, 4, 696));
  EXPECT_NEAR(input.tools[1].z(), 500.4, 1e-9);
}

TEST(ScenePlay, AToolAtRestFeelsAnObjectThatMovesIntoIt) {
  const Scene scene = one_sheet();
  const SceneTrace trace = play(scene, rising_sheet());
  ASSERT_EQ(trace.tools.size(), 2U);
  ASSERT_EQ(trace.tools[0].size(), 301U);
  EXPECT_EQ(trace.tools[0][140].object, -1);
  const SceneTracePoint& end = trace.tools[0].back();
  EXPECT_EQ(end.object, 0);
  // 5 mm deep: the sheet, whose outside is towards -z, pushes the tool to -z.
  const double force = 4 * 5 / std::hypot(5, 10);
  EXPECT_LT((end.felt.force - Eigen::Vector3d(0, 0, -force)).norm(), 1e-9);
  EXPECT_LT((end.felt.contact - Eigen::Vector3d(3, 4, 691)).norm(), 1e-9);
  const ObjectLoad& load = trace.objects[0].back().load;
  EXPECT_LT((load.force - Eigen::Vector3d(0, 0, force)).norm(), 1e-9);
  EXPECT_LT((load.torque - Eigen::Vector3d(4 * force, -3 * force, 0)).norm(), 1e-9);
  EXPECT_EQ(trace.tools[1].back().felt.force, Eigen::Vector3d::Zero());
}

TEST(ScenePlay, WritesTracesThatReadBackExactly) {
  const ScratchFolder scratch;
  const Scene scene = one_sheet();
  const SceneTrace trace = play(scene, rising_sheet());
  write_tool_trace(scratch / "tool.csv", scene, trace.tools[0]);
  write_load_trace(scratch / "load.csv", trace.objects[0]);
  const std::array<std::string_view, 4> tool_columns{"t", "fz", "object", "share"};
  probing::CsvReader row(scratch / "tool.csv", tool_columns);
  for (const SceneTracePoint& point : trace.tools[0]) {
    ASSERT_TRUE(row.next());
    ASSERT_EQ(row.number(0), point.felt.time);
    ASSERT_EQ(row.number(1), point.felt.force.z());
    ASSERT_EQ(row.text(2), point.object < 0 ? "" : "sheet");
    ASSERT_EQ(row.number(3), 1);
  }
  const std::array<std::string_view, 7> load_columns{"t", "fx", "fy", "fz", "tx", "ty", "tz"};
  probing::CsvReader load(scratch / "load.csv", load_columns);
  for (const LoadPoint& point : trace.objects[0]) {
    ASSERT_TRUE(load.next());
    ASSERT_EQ(load.vector(1), point.load.force);
    ASSERT_EQ(load.vector(4), point.load.torque);
  }
}

TEST(ScenePlay, RefusesWaysThatDoNotFitTheScene) {
  const Scene scene = one_sheet();
  SceneMotion motion = rising_sheet();
  motion.tools.clear();
  EXPECT_THAT(refusal([&] { return play(scene, motion); }), HasSubstr("there is no tool"));
  motion = rising_sheet();
  motion.rate = kNaN;
  EXPECT_THAT(refusal([&] { return play(scene, motion); }), HasSubstr("SceneMotion::rate"));
  motion = rising_sheet();
  motion.rate = 1e9;
  EXPECT_THAT(refusal([&] { return play(scene, motion); }), HasSubstr("less than 1e7 ticks"));
  motion = rising_sheet();
  motion.objects.push_back(motion.objects[0]);
  EXPECT_THAT(refusal([&] { return play(scene, motion); }),
              HasSubstr("ways of 2 objects; the scene has 1"));
}

}  // namespace
}  // namespace palpate::haptics
