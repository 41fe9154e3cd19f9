// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "tool_motion.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "test_surfaces.h"

namespace palpate::view {
namespace {

constexpr double kDiagonal = 100;  // [mm]
const Eigen::Vector3d kAside(0, 0, 5000);

ToolWish press_at(const Eigen::Vector3d& place, double depth) {
  return {.presses = 1, .pressed = true, .at = {place, Eigen::Vector3d::UnitZ()}, .depth = depth};
}

TEST(ToolMotion, LiesAsideUntilSomethingIsPressed) {
  ToolMotion motion(kDiagonal, kAside);
  for (int tick = 0; tick < 5; ++tick) EXPECT_EQ(motion.tick({}), kAside);
}

TEST(ToolMotion, WaitsAboveTheSurfaceAndThenSinksToTheDepth) {
  ToolMotion motion(kDiagonal, kAside);
  const ToolWish wish = press_at({10, 20, 0}, 5);
  const double above = motion.tick(wish).z();
  EXPECT_GT(above, 0);
  EXPECT_LT(above, 0.01 * kDiagonal);
  for (int tick = 1; tick < ToolMotion::kWaitingTicks; ++tick)
    EXPECT_EQ(motion.tick(wish).z(), above) << "while playback forgets the jump";
  double before = above;
  for (int tick = 0; tick < 1500; ++tick) {
    const Eigen::Vector3d tool = motion.tick(wish);
    EXPECT_LT(tool.z(), before);
    EXPECT_EQ(tool.x(), 10);
    EXPECT_EQ(tool.y(), 20);
    before = tool.z();
  }
  EXPECT_NEAR(before, -5, 0.05);
}

TEST(ToolMotion, FollowsAFlickWithoutAJump) {
  ToolMotion motion(kDiagonal, kAside);
  ToolWish wish = press_at({0, 0, 0}, 5);
  Eigen::Vector3d before = motion.tick(wish);
  for (int tick = 0; tick < 500; ++tick) before = motion.tick(wish);
  wish.at.position = {60, 0, 0};
  wish.at.normal = Eigen::Vector3d(1, 0, 1).normalized();
  for (int tick = 0; tick < 1000; ++tick) {
    const Eigen::Vector3d tool = motion.tick(wish);
    ASSERT_LT((tool - before).norm(), 0.006 * kDiagonal);
    before = tool;
  }
  const Eigen::Vector3d wanted = wish.at.position - 5 * wish.at.normal;
  EXPECT_NEAR((before - wanted).norm(), 0, 0.2);
}

TEST(ToolMotion, LiftsTheToolOffBeforeItIsLaidAside) {
  ToolMotion motion(kDiagonal, kAside);
  ToolWish wish = press_at({0, 0, 0}, 5);
  Eigen::Vector3d tool;
  for (int tick = 0; tick < 800; ++tick) tool = motion.tick(wish);
  wish.pressed = false;
  double highest = tool.z();
  int ticks = 0;
  for (; (tool = motion.tick(wish)) != kAside; ++ticks) {
    ASSERT_LT(ticks, 1000);
    EXPECT_GE(tool.z(), highest);
    highest = tool.z();
  }
  EXPECT_GT(highest, 0) << "free before it goes";
  EXPECT_EQ(motion.tick(wish), kAside);
}

TEST(ToolMotion, ForgetsAClickThatWasOverBeforeItsFirstTick) {
  ToolMotion motion(kDiagonal, kAside);
  ToolWish wish = press_at({0, 0, 0}, 5);
  wish.pressed = false;
  for (int tick = 0; tick < 5; ++tick) EXPECT_EQ(motion.tick(wish), kAside);
}

TEST(ToolMotion, BeginsASecondPressOnlyWhenTheFirstIsLifted) {
  ToolMotion motion(kDiagonal, kAside);
  ToolWish wish = press_at({0, 0, 0}, 5);
  for (int tick = 0; tick < 500; ++tick) static_cast<void>(motion.tick(wish));
  wish.presses = 2;
  wish.at.position = {40, 0, 0};
  bool was_aside = false;
  Eigen::Vector3d tool;
  for (int tick = 0; tick < 1000; ++tick) {
    tool = motion.tick(wish);
    was_aside = was_aside || tool == kAside;
  }
  EXPECT_TRUE(was_aside) << "otherwise the tool would cross the object";
  EXPECT_EQ(tool.x(), 40);
  EXPECT_LT(tool.z(), 0);
}

TEST(ToolAim, DragsToThePlaceUnderThePointer) {
  const geometry::TriangleMesh sheet = geometry::test::flat_sheet(10, 10, 10);
  const geometry::SurfaceQuery query(sheet);
  ToolAim aim(kDiagonal);
  aim.press({{50, 50, 0}, Eigen::Vector3d::UnitZ()});
  const geometry::Ray ray{.origin = {40, 80, 100},
                          .direction = Eigen::Vector3d(0, -0.1, -1).normalized()};
  aim.drag(ray, query, sheet);
  EXPECT_NEAR((aim.wish().at.position - Eigen::Vector3d(40, 70, 0)).norm(), 0, 1e-9);
  // Beside the sheet, on the plane of the press.
  aim.drag({.origin = {-20, 50, 100}, .direction = -Eigen::Vector3d::UnitZ()}, query, sheet);
  EXPECT_NEAR((aim.wish().at.position - Eigen::Vector3d(-20, 50, 0)).norm(), 0, 1e-9);
  // A ray along the plane says nothing.
  aim.drag({.origin = {0, 0, 1}, .direction = Eigen::Vector3d::UnitX()}, query, sheet);
  EXPECT_NEAR((aim.wish().at.position - Eigen::Vector3d(-20, 50, 0)).norm(), 0, 1e-9);
}

TEST(ToolAim, DoesNotJumpToAnotherPartOfTheObject) {
  // Two sheets, one 40 mm above the other, beside it.
  geometry::TriangleMesh stairs =
      geometry::test::height_field(10, 1, 10, [](double x, double) { return x > 45 ? 40.0 : 0.0; });
  const geometry::SurfaceQuery query(stairs);
  ToolAim aim(kDiagonal);
  aim.press({{20, 5, 0}, Eigen::Vector3d::UnitZ()});
  aim.drag({.origin = {80, 5, 100}, .direction = -Eigen::Vector3d::UnitZ()}, query, stairs);
  EXPECT_NEAR((aim.wish().at.position - Eigen::Vector3d(80, 5, 0)).norm(), 0, 1e-9);
}

TEST(ToolAim, PicksOnlyTheOutside) {
  const geometry::TriangleMesh sheet = geometry::test::flat_sheet(2, 2, 10);
  const geometry::SurfaceQuery query(sheet);
  const auto hit = pick(query, sheet, {.origin = {5, 5, 10}, .direction = {0, 0, -1}});
  ASSERT_TRUE(hit.has_value());
  EXPECT_EQ(hit->normal, Eigen::Vector3d(0, 0, 1));
  EXPECT_FALSE(pick(query, sheet, {.origin = {5, 5, -10}, .direction = {0, 0, 1}}).has_value());
  EXPECT_FALSE(pick(query, sheet, {.origin = {50, 5, 10}, .direction = {0, 0, -1}}).has_value());
}

TEST(ToolAim, KeepsTheDepthWithinItsRange) {
  ToolAim aim(kDiagonal);
  aim.set_depth(1e9);
  EXPECT_EQ(aim.wish().depth, aim.deepest());
  aim.set_depth(-1);
  EXPECT_EQ(aim.wish().depth, aim.shallowest());
}

}  // namespace
}  // namespace palpate::view
