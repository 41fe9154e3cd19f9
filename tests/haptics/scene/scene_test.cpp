// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "../playback/allocation_counter.h"
#include "not_finite.h"
#include "palpate/haptics/rotation.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

std::shared_ptr<const Playback> shared_sheet() {
  static const auto sheet = std::make_shared<const Playback>(uneven_model());
  return sheet;
}
// The same spring at each place: 4 d / sqrt(d^2 + 100).
std::shared_ptr<const Playback> shared_even_sheet() {
  static const auto sheet = std::make_shared<const Playback>(sheet_model(0.5));
  return sheet;
}

Isometry3d shifted(double x, double y = 0, double z = 0) {
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() << x, y, z;
  return pose;
}

// From 0.2 m away, presses into the sheet, drags, lifts and leaves; 1 to 2 mm in a tick.
std::vector<Vector3d> visit() {
  const std::vector<Vector3d> corners{{200, -60, 500}, {3, 4, 690},   {3, 4, 706},  {20, -10, 705},
                                      {-35, 10, 704},  {-30, 5, 690}, {-90, 5, 400}};
  std::vector<Vector3d> path;
  for (std::size_t leg = 1; leg < corners.size(); ++leg) {
    constexpr int kLegTicks = 150;
    for (int i = 0; i < kLegTicks; ++i)
      path.push_back(corners[leg - 1] + i / double{kLegTicks} * (corners[leg] - corners[leg - 1]));
  }
  return path;
}

// A way of an object: it shifts and turns about a changing axis.
Isometry3d wandering_pose(double t) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = rotation_exp({0.4 * std::sin(2 * t), 0.3 * std::cos(3 * t), t});
  pose.translation() << 300 + 40 * std::sin(t), -20 * t, 15 * std::cos(2 * t);
  return pose;
}

TEST(Scene, AToolFeelsOneObjectBitByBitAsInPlayback) {
  const Scene scene({{"near", shared_sheet()}, {"far", shared_sheet()}});
  SceneState state = scene.start(1);
  LoopState single;
  const std::array<Isometry3d, 2> poses{Isometry3d::Identity(), shifted(1000)};
  int touching = 0, slips = 0;
  for (const Vector3d& place : visit()) {
    const Command alone = shared_sheet()->step(place, single);
    const ToolCommand& felt = scene.step(poses, {&place, 1}, state).tools[0];
    ASSERT_EQ(felt.command.force, alone.force);
    ASSERT_EQ(felt.command.contact, alone.contact);
    ASSERT_EQ(felt.command.state, alone.state);
    ASSERT_EQ(felt.command.limited, alone.limited);
    ASSERT_EQ(felt.object, alone.state == ContactState::free ? -1 : 0);
    touching += felt.object == 0;
    slips += alone.state == ContactState::slip;
  }
  EXPECT_GT(touching, 300);
  EXPECT_GT(slips, 50);
}

TEST(Scene, EachOfTwoObjectsFarApartAnswersAsAlone) {
  const Scene scene({{"left", shared_sheet()}, {"right", shared_even_sheet()}});
  SceneState both = scene.start(2);
  LoopState left, right;
  const std::array<Isometry3d, 2> poses{Isometry3d::Identity(), shifted(2000)};
  const std::vector<Vector3d> path = visit();
  for (std::size_t i = 0; i < path.size(); ++i) {
    const std::array<Vector3d, 2> tools{path[i], path[path.size() - 1 - i] + Vector3d(2000, 0, 0)};
    const SceneCommand& all = scene.step(poses, tools, both);
    ASSERT_EQ(all.tools[0].command.force, shared_sheet()->step(tools[0], left).force);
    ASSERT_EQ(all.tools[1].command.force,
              shared_even_sheet()->step(tools[1] - Vector3d(2000, 0, 0), right).force);
  }
}

TEST(Scene, MovingTheWorldRigidlyMovesTheAnswerWithIt) {
  const Scene scene({{"sheet", shared_sheet()}});
  SceneState here = scene.start(1), there = scene.start(1);
  const Isometry3d motion = some_motion();
  double largest = 0;
  for (std::size_t i = 0; const Vector3d& place : visit()) {
    const Isometry3d pose = wandering_pose(1e-3 * static_cast<double>(i++));
    const Isometry3d moved_pose = motion * pose;
    const Vector3d tool = pose * place, moved_tool = motion * tool;
    const SceneCommand& one = scene.step({&pose, 1}, {&tool, 1}, here);
    const SceneCommand& other = scene.step({&moved_pose, 1}, {&moved_tool, 1}, there);
    ASSERT_LT((other.tools[0].command.force - motion.linear() * one.tools[0].command.force).norm(),
              1e-9);
    ASSERT_LT((other.tools[0].command.contact - motion * one.tools[0].command.contact).norm(),
              1e-9);
    ASSERT_LT((other.objects[0].torque - motion.linear() * one.objects[0].torque).norm(), 1e-6);
    largest = std::max(largest, one.tools[0].command.force.norm());
  }
  EXPECT_GT(largest, 1);
}

TEST(Scene, AnObjectThatMovesAgainstAToolIsFeltLikeAToolThatMoves) {
  const Scene scene({{"sheet", shared_sheet()}});
  SceneState state = scene.start(1);
  LoopState single;
  const Vector3d resting(10, 20, 30);
  double largest = 0;
  for (std::size_t i = 0; const Vector3d& place : visit()) {
    Isometry3d pose = wandering_pose(1e-3 * static_cast<double>(i++));
    pose.translation() = resting - pose.linear() * place;
    const Command command = scene.step({&pose, 1}, {&resting, 1}, state).tools[0].command;
    const Command relative = shared_sheet()->step(place, single);
    ASSERT_LT((command.force - pose.linear() * relative.force).norm(), 1e-9);
    largest = std::max(largest, command.force.norm());
  }
  EXPECT_GT(largest, 1);
}

TEST(Scene, ForcesOfObjectsThatOverlapAddUp) {
  const Scene scene({{"even", shared_even_sheet()}, {"uneven", shared_sheet()}});
  SceneState state = scene.start(1);
  LoopState even, uneven;
  const std::array<Isometry3d, 2> poses{Isometry3d::Identity(), shifted(0, 0, 2)};
  for (const double depth : {-5.0, 1.0, 3.0, 5.0}) {
    const Vector3d tool(3, 4, 700 + depth);
    const SceneCommand& all = scene.step(poses, {&tool, 1}, state);
    const Vector3d first = shared_even_sheet()->step(tool, even).force,
                   second = shared_sheet()->step(tool - Vector3d(0, 0, 2), uneven).force;
    EXPECT_EQ(all.tools[0].command.force, first + second);
    EXPECT_EQ(all.objects[0].force, -first);
    EXPECT_EQ(all.objects[1].force, -second);
    const int stronger = second.norm() > first.norm() ? 1 : 0;
    EXPECT_EQ(all.tools[0].object, depth < 0 ? -1 : stronger);
  }
}

TEST(Scene, TheOrderOfObjectsAndToolsDoesNotMatter) {
  const Scene scene({{"a", shared_sheet()}, {"b", shared_even_sheet()}}),
      turned({{"b", shared_even_sheet()}, {"a", shared_sheet()}});
  SceneState state = scene.start(2), turned_state = turned.start(2);
  const std::array<Isometry3d, 2> poses{Isometry3d::Identity(), shifted(3, 0, 1)},
      turned_poses{poses[1], poses[0]};
  const std::vector<Vector3d> path = visit();
  int near = 0;
  for (std::size_t i = 100; i < path.size(); ++i) {
    const std::array<Vector3d, 2> tools{path[i], path[i - 100]}, swapped{tools[1], tools[0]};
    const SceneCommand& one = scene.step(poses, tools, state);
    const SceneCommand& other = turned.step(turned_poses, swapped, turned_state);
    for (std::size_t k = 0; k < 2; ++k) {
      ASSERT_LT((one.tools[k].command.force - other.tools[1 - k].command.force).norm(), 1e-12);
      ASSERT_LT((one.objects[k].torque - other.objects[1 - k].torque).norm(), 1e-9);
      ASSERT_EQ(one.tools[k].share, other.tools[1 - k].share);
      near += one.tools[k].share < 1;
    }
  }
  EXPECT_GT(near, 50);
}

// The spring of the sheet holds 4 (sqrt(d^2 + 100) - 10): what users and movers of the object put
// in, by force and torque, is in it, and comes back when all returns.
TEST(Scene, LoadsOnTheObjectBalanceTheEnergyOfItsMotion) {
  const Scene scene({{"sheet", shared_even_sheet()}});
  SceneState state = scene.start(1);
  Isometry3d pose = Isometry3d::Identity();
  Vector3d tool(3, 4, 699);
  static_cast<void>(scene.step({&pose, 1}, {&tool, 1}, state));
  ToolCommand felt;
  ObjectLoad load;
  double work = 0;
  const auto move_on = [&](const Isometry3d& to, const Vector3d& tool_to) {
    const Isometry3d way = to * pose.inverse();
    const SceneCommand& now = scene.step({&to, 1}, {&tool_to, 1}, state);
    work -= (felt.command.force + now.tools[0].command.force).dot(tool_to - tool) / 2;
    work -= (load.force + now.objects[0].force).dot(to.translation() - pose.translation()) / 2 +
            (load.torque + now.objects[0].torque).dot(rotation_log(way.linear())) / 2;
    felt = now.tools[0];
    load = now.objects[0];
    pose = to;
    tool = tool_to;
  };
  constexpr int kWayTicks = 2000;
  for (int i = 1; i <= kWayTicks; ++i) {
    const double t = i / double{kWayTicks};
    // The object turns about a place 0.7 m from its contact, and the tool moves too.
    Isometry3d to = Isometry3d::Identity();
    to.linear() = rotation_exp({-2e-3 * t, 3e-3 * t, 1e-2 * t});
    to.translation() << 2 * t, -t, -9 * t;
    move_on(to, {3 + 6 * t, 4 + t * t, 699 + t});
  }
  ASSERT_EQ(felt.command.state, ContactState::stick);
  const Vector3d displacement = pose.inverse() * tool - pose.inverse() * felt.command.contact;
  EXPECT_GT(displacement.norm(), 3);
  const double energy = 4 * (std::hypot(displacement.norm(), 10) - 10);
  EXPECT_NEAR(work, energy, 1e-4 * energy);
}

TEST(Scene, APoseThatIsNoneHoldsItsObjectAndRecovers) {
  const Scene scene({{"faulty", shared_even_sheet()}, {"sound", shared_even_sheet()}});
  const std::array<Vector3d, 2> above{Vector3d(3, 4, 695), Vector3d(1003, 4, 695)},
      pressed{Vector3d(3, 4, 705), Vector3d(1003, 4, 705)};
  std::vector<Isometry3d> faults(5, Isometry3d::Identity());
  faults[0].translation().x() = kNaN;
  faults[1].linear()(0, 1) = kInf;
  faults[2].linear() *= 1.001;
  faults[3].linear().col(0) *= -1;
  faults[4].linear()(0, 1) = 1e-3;
  for (const Isometry3d& fault : faults) {
    SceneState state = scene.start(2);
    std::array<Isometry3d, 2> poses{Isometry3d::Identity(), shifted(1000)};
    static_cast<void>(scene.step(poses, above, state));
    const SceneCommand touching = scene.step(poses, pressed, state);
    ASSERT_GT(touching.tools[0].command.force.norm(), 1);
    double before = touching.tools[0].command.force.norm();
    poses[0] = fault;
    for (int i = 0; i < 5; ++i) {
      const SceneCommand& held = scene.step(poses, pressed, state);
      EXPECT_TRUE(held.objects[0].held);
      EXPECT_FALSE(held.objects[1].held);
      EXPECT_TRUE(held.tools[0].command.held);
      EXPECT_FALSE(held.tools[1].command.held);
      EXPECT_LT(held.tools[0].command.force.norm(), before);
      EXPECT_EQ(held.objects[0].force, -held.tools[0].command.force);
      EXPECT_EQ(held.tools[1].command.force, touching.tools[1].command.force);
      before = held.tools[0].command.force.norm();
    }
    poses[0] = Isometry3d::Identity();
    for (int i = 0; i < 20; ++i) static_cast<void>(scene.step(poses, pressed, state));
    EXPECT_FALSE(state.command().tools[0].command.held);
    EXPECT_LT((state.command().tools[0].command.force - touching.tools[0].command.force).norm(),
              1e-9);
    // Beyond `hold_ticks` the force is zero. Missing counts as well.
    for (int i = 0; i < 30; ++i) static_cast<void>(scene.step({}, pressed, state));
    EXPECT_EQ(state.command().tools[0].command.force, Vector3d::Zero());
    EXPECT_EQ(state.command().objects[0].torque, Vector3d::Zero());
    EXPECT_TRUE(scene.step(poses, pressed, state).tools[0].command.started_inside);
  }
}

TEST(Scene, AToolThatIsNowhereHoldsAlone) {
  const Scene scene({{"sheet", shared_even_sheet()}});
  SceneState state = scene.start(2);
  const Isometry3d pose = Isometry3d::Identity();
  std::array<Vector3d, 2> tools{Vector3d(-30, 0, 695), Vector3d(30, 0, 695)};
  static_cast<void>(scene.step({&pose, 1}, tools, state));
  for (Vector3d& tool : tools) tool.z() = 704;
  const SceneCommand touching = scene.step({&pose, 1}, tools, state);
  for (const int given : {1, 2}) {
    tools[1].x() = kNaN;
    const SceneCommand& held =
        scene.step({&pose, 1}, {tools.data(), static_cast<std::size_t>(given)}, state);
    EXPECT_EQ(held.tools[0].command.force, touching.tools[0].command.force);
    EXPECT_FALSE(held.tools[0].command.held);
    EXPECT_TRUE(held.tools[1].command.held);
    EXPECT_LT(held.tools[1].command.force.norm(), touching.tools[1].command.force.norm());
    EXPECT_TRUE(held.objects[0].torque.allFinite());
  }
}

TEST(Scene, AStateOfAnotherSceneIsHeldWithoutForce) {
  const Scene scene({{"sheet", shared_even_sheet()}}), other({{"sheet", shared_even_sheet()}});
  SceneState state = other.start(1);
  const Isometry3d pose = Isometry3d::Identity();
  for (const double z : {695.0, 705.0}) {
    const Vector3d tool(3, 4, z);
    const SceneCommand& held = scene.step({&pose, 1}, {&tool, 1}, state);
    EXPECT_TRUE(held.tools[0].command.held);
    EXPECT_EQ(held.tools[0].command.force, Vector3d::Zero());
  }
}

TEST(Scene, RefusesWhatIsNoScene) {
  EXPECT_THAT(refusal([] { return Scene({}); }), HasSubstr("there is no object"));
  EXPECT_THAT(refusal([] { return Scene({{"", shared_sheet()}}); }), HasSubstr("has no name"));
  EXPECT_THAT(refusal([] {
                return Scene({{"a", shared_sheet()}, {"a", shared_sheet()}});
              }),
              HasSubstr("two objects have the name 'a'"));
  EXPECT_THAT(refusal([] { return Scene({{"a", nullptr}}); }), HasSubstr("'a' has no playback"));
  EXPECT_THAT(refusal([] {
                return Scene({{"a", shared_sheet()}}, {.closest_tools = -1});
              }),
              HasSubstr("closest_tools is -1"));
  EXPECT_THAT(refusal([] {
                return Scene({{"a", shared_sheet()}}, {.fade_ticks = 0});
              }),
              HasSubstr("fade_ticks is 0"));
  EXPECT_THAT(refusal([] {
                return Scene({{"a", shared_sheet()}}).start(0);
              }),
              HasSubstr("tools is 0"));
}

TEST(Scene, DoesNotAllocateInTheLoop) {
  if (!test::counts_allocations()) GTEST_SKIP() << "the sanitizer's allocator cannot be counted";
  const Scene scene({{"a", shared_sheet()}, {"b", shared_even_sheet()}});
  SceneState state = scene.start(3);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const long before = test::allocations();
  int touching = 0, bad = 0;
  for (int i = 0; i < 5000; ++i) {
    std::array<Isometry3d, 2> poses{wandering_pose(1e-3 * i), wandering_pose(2 + 1e-3 * i)};
    std::array<Vector3d, 3> tools;
    for (std::size_t t = 0; t < 3; ++t) {
      constexpr std::array<double, 4> reaches{1, 5, 50, 1e4};
      tools[t] = poses[t % 2] * (Vector3d(10.0 * static_cast<double>(t), 0, 702) +
                                 reaches[random() % 64 / 21] *
                                     Vector3d{uniform(random), uniform(random), uniform(random)});
      if (random() % 50 == 0) tools[t].y() = kNaN;
    }
    if (random() % 50 == 0) poses[random() % 2].linear() *= 2;
    const SceneCommand& all = scene.step(poses, tools, state);
    for (const ToolCommand& tool : all.tools) {
      touching += tool.object >= 0;
      bad += !tool.command.force.allFinite() || !(tool.share >= 0 && tool.share <= 1);
    }
    for (const ObjectLoad& load : all.objects) bad += !load.torque.allFinite();
  }
  EXPECT_EQ(test::allocations(), before);
  EXPECT_GT(touching, 2000);
  EXPECT_EQ(bad, 0);
}

// Two tools press at (-30, 0) and at (30, 0), the first one before the other; then the second one
// goes to the first and back.
struct Approach {
  std::vector<double> distances;
  std::vector<SceneCommand> commands;
};
Approach approach(const SceneOptions& options, double closest) {
  const Scene scene({{"sheet", shared_even_sheet()}}, options);
  SceneState state = scene.start(2);
  const Isometry3d pose = Isometry3d::Identity();
  Approach result;
  const auto step = [&](double first_depth, double depth, double x) {
    const std::array<Vector3d, 2> tools{Vector3d(-30, 0, 700 + first_depth),
                                        Vector3d(x, 0, 700 + depth)};
    const SceneCommand& all = scene.step({&pose, 1}, tools, state);
    const Vector3d between = all.tools[1].command.contact - all.tools[0].command.contact;
    result.distances.push_back(between.norm());
    result.commands.push_back(all);
  };
  constexpr int kDown = 100, kAlong = 1000;
  for (int i = -10; i <= kDown; ++i) step(5.0 * i / kDown, -5, 30);
  for (int i = -10; i <= kDown; ++i) step(5, 5.0 * i / kDown, 30);
  for (int i = 0; i <= kAlong; ++i) step(5, 5, 30 - (60 - closest) * i / kAlong);
  for (int i = 0; i <= kAlong; ++i) step(5, 5, -30 + closest + (60 - closest) * i / kAlong);
  return result;
}

TEST(SceneNearTools, TheLaterContactFadesWithTheDistanceAndTheEarlierOneStays) {
  const Approach near = approach({.closest_tools = 40}, 2),
                 alone = approach({.near_tools = NearTools::independent}, 2);
  double before = 1, least = 1;
  Vector3d force = Vector3d::Zero();
  for (std::size_t i = 0; i < near.commands.size(); ++i) {
    const ToolCommand &first = near.commands[i].tools[0], &second = near.commands[i].tools[1];
    ASSERT_EQ(first.share, 1);
    ASSERT_EQ(first.command.force, alone.commands[i].tools[0].command.force);
    ASSERT_EQ(second.command.force, second.share * alone.commands[i].tools[1].command.force);
    ASSERT_LE(second.share, before);  // as it goes away again too
    ASSERT_LT((second.command.force - force).norm(), 0.1);
    if (near.distances[i] >= 40 && before == 1) {
      ASSERT_EQ(second.share, 1) << i;
    }
    before = second.share;
    force = second.command.force;
    least = std::min(least, before);
  }
  // 3 (2/40)^2 at the end; the contact trails the tool by 2.5 mm (friction 0.5 at 5 mm depth).
  const double nearest = *std::ranges::min_element(near.distances) / 40;
  EXPECT_LT(nearest, 5 / 40.0);
  EXPECT_NEAR(least, nearest * nearest * (3 - 2 * nearest), 1e-12);
}

TEST(SceneNearTools, ARefusedContactLosesItsForceInFadeTicksAndFeelsTheObjectAgainAfterALift) {
  const SceneOptions options{
      .near_tools = NearTools::refuse, .closest_tools = 20, .fade_ticks = 10};
  const Approach near = approach(options, 2);
  int falling = 0;
  for (std::size_t i = 1; i < near.commands.size(); ++i) {
    const double share = near.commands[i].tools[1].share;
    const double fall = near.commands[i - 1].tools[1].share - share;
    ASSERT_GE(fall, 0);
    ASSERT_LE(fall, 0.1 + 1e-12);
    falling += fall > 1e-12;
  }
  EXPECT_EQ(falling, 10);
  EXPECT_EQ(near.commands.back().tools[1].share, 0);
  EXPECT_EQ(near.commands.back().tools[1].command.state, ContactState::slip);
  EXPECT_GT(near.distances.back(), 50);

  // The same tools from the start, with a lift between.
  const Scene scene({{"sheet", shared_even_sheet()}}, options);
  SceneState state = scene.start(2);
  const Isometry3d pose = Isometry3d::Identity();
  const auto at = [&](double x, double depth) {
    const std::array<Vector3d, 2> tools{Vector3d(0, 0, 704), Vector3d(x, 0, 700 + depth)};
    return scene.step({&pose, 1}, tools, state).tools[1];
  };
  static_cast<void>(at(10, -5));
  EXPECT_EQ(at(10, 2).share, 0);
  EXPECT_EQ(at(10, 3).command.force, Vector3d::Zero());
  EXPECT_EQ(at(10, 3).command.state, ContactState::stick);
  for (int i = 0; i < 9; ++i) static_cast<void>(at(10 + 3 * i, -5));
  static_cast<void>(at(40, -5));
  EXPECT_EQ(at(40, 2).share, 1);
  EXPECT_GT(at(40, 2).command.force.norm(), 0.5);
}

// The first tool rests 5 mm from where the second one presses, lifts off, and then the second one
// lifts: pressed with a share of the force, it must not come back with all of it.
TEST(SceneNearTools, GiveTheUsersNoEnergy) {
  for (const NearTools rule : {NearTools::fade, NearTools::refuse}) {
    const Scene scene({{"sheet", shared_even_sheet()}}, {.near_tools = rule});
    SceneState state = scene.start(2);
    const Isometry3d pose = Isometry3d::Identity();
    std::array<Vector3d, 2> tools{Vector3d(0, 0, 695), Vector3d(5, 0, 695)}, forces;
    forces.fill(Vector3d::Zero());
    double gained = 0, most_stored = 0;
    const auto go = [&](double first_depth, double second_depth) {
      const std::array<Vector3d, 2> from = tools;
      const std::array<double, 2> depths{first_depth, second_depth};
      constexpr int kGoTicks = 300;
      for (int i = 1; i <= kGoTicks; ++i) {
        for (std::size_t t = 0; t < 2; ++t) {
          const Vector3d before = tools[t];
          tools[t].z() = from[t].z() + i / double{kGoTicks} * (700 + depths[t] - from[t].z());
          gained += forces[t].dot(tools[t] - before) / 2;
        }
        const SceneCommand& all = scene.step({&pose, 1}, tools, state);
        for (std::size_t t = 0; t < 2; ++t) {
          const double way = (700 + depths[t] - from[t].z()) / kGoTicks;
          forces[t] = all.tools[t].command.force;
          gained += forces[t].z() * way / 2;
        }
      }
      most_stored = std::max(most_stored, -gained);
    };
    go(3, -5);
    const double first_alone = most_stored;
    go(3, 6);
    EXPECT_LT(state.command().tools[1].share, 0.11);
    EXPECT_LT(most_stored - first_alone, 0.11 * 4 * (std::hypot(6, 10) - 10));
    go(-5, 6);
    go(-5, -5);
    EXPECT_GT(first_alone, 1.5);
    EXPECT_LT(gained, 1e-3);  // [N mm]
    EXPECT_EQ(state.command().tools[1].command.force, Vector3d::Zero());
  }
}

}  // namespace
}  // namespace palpate::haptics
