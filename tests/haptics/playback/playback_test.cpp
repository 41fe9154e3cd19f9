// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/playback.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "allocation_counter.h"
#include "hand_model.h"
#include "height_field_model.h"
#include "not_finite.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/contact_compliance.h"
#include "playback_hand.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

const Eigen::Vector3d kAbove(3, 4, 695);

// Force of the sheet on a tool at this displacement: minus the spring's.
Eigen::Vector3d reaction(const Eigen::Vector3d& displacement) {
  return -4 * displacement / std::hypot(displacement.norm(), 10);
}

// Presses, drags there and back and beyond the border of the contacts, and lifts off.
std::vector<TrajectoryPoint> some_trajectory() {
  const std::vector<Eigen::Vector3d> corners = {kAbove,         {3, 4, 706}, {20, -10, 705},
                                                {-40, 10, 704}, {5, 5, 708}, {5, 5, 690}};
  std::vector<TrajectoryPoint> trajectory;
  for (std::size_t leg = 1; leg < corners.size(); ++leg) {
    constexpr int kTicks = 400;
    for (int i = 0; i < kTicks; ++i) {
      const double way = static_cast<double>(i) / kTicks;
      trajectory.push_back({1e-3 * static_cast<double>(trajectory.size()),
                            (1 - way) * corners[leg - 1] + way * corners[leg]});
    }
  }
  return trajectory;
}

TEST(Playback, TouchesSticksSlipsAndLiftsOff) {
  const Playback playback(sheet_model(0.5));
  LoopState state;
  Command command = playback.step(kAbove, state);
  EXPECT_EQ(command.state, ContactState::free);
  EXPECT_EQ(command.force, Eigen::Vector3d::Zero());
  EXPECT_EQ(command.contact, kAbove);

  command = playback.step({3, 4, 705}, state);
  EXPECT_EQ(command.state, ContactState::stick);
  EXPECT_LT((command.contact - Eigen::Vector3d(3, 4, 700)).norm(), 1e-9);
  EXPECT_LT((command.force - reaction({0, 0, 5})).norm(), 1e-9);

  command = playback.step({5, 4, 705}, state);  // 2 mm aside at a depth of 5: inside the cone
  EXPECT_EQ(command.state, ContactState::stick);
  EXPECT_LT((command.force - reaction({2, 0, 5})).norm(), 1e-9);

  command = playback.step({9, 4, 705}, state);  // 6 mm aside: the contact trails by 0.5 * 5 mm
  EXPECT_EQ(command.state, ContactState::slip);
  EXPECT_NEAR(command.contact.x(), 6.5, 2e-3);
  EXPECT_LT((command.force - reaction({2.5, 0, 5})).norm(), 2e-3);

  command = playback.step({9, 4, 699.9}, state);
  EXPECT_EQ(command.state, ContactState::free);
  EXPECT_EQ(command.force, Eigen::Vector3d::Zero());
}

TEST(Playback, SlipsBackWithoutJumpingToTheFarSideOfTheCone) {
  const Playback playback(sheet_model(0.5));
  const std::vector<TracePoint> trace = play(playback, some_trajectory());
  int slips = 0;
  for (std::size_t i = 1; i < trace.size(); ++i) {
    // The fastest leg moves 0.15 mm a tick at a stiffness of at most 0.4 N/mm.
    EXPECT_LT((trace[i].force - trace[i - 1].force).norm(), 0.12) << i;
    slips += trace[i].state == ContactState::slip;
  }
  EXPECT_GT(slips, 500);
}

TEST(Playback, IgnoresASurfaceThatIsEnteredFromBehind) {
  const Playback playback(sheet_model());
  LoopState state;
  EXPECT_EQ(playback.step({0, 0, 730}, state).state, ContactState::free);  // too deep for a start
  EXPECT_EQ(playback.step({0, 0, 710}, state).state, ContactState::free);
  EXPECT_EQ(playback.step({0, 0, 690}, state).state, ContactState::free);
  EXPECT_EQ(state.proxy.position.z(),
            690);  // it passed through, and was not stopped at the surface
  EXPECT_EQ(playback.step({0, 0, 701}, state).state, ContactState::stick);
}

TEST(Playback, ReportsAStartInsideAndRaisesTheForceSlowly) {
  const Model model = sheet_model();
  const double jump = *playback_options_for(model, {}).largest_jump;
  const Playback playback(model);
  LoopState state;
  Command command = playback.step({0, 0, 705}, state);
  EXPECT_TRUE(command.started_inside);
  EXPECT_TRUE(command.limited);
  EXPECT_EQ(command.state, ContactState::stick);
  EXPECT_EQ(command.contact, Eigen::Vector3d(0, 0, 700));
  double before = 0;
  for (int i = 0; i < 30; ++i) {
    EXPECT_LE(command.force.norm(), before + jump + 1e-12);
    before = command.force.norm();
    command = playback.step({0, 0, 705}, state);
    EXPECT_FALSE(command.started_inside);
  }
  EXPECT_FALSE(command.limited);
  EXPECT_LT((command.force - reaction({0, 0, 5})).norm(), 1e-9);
}

TEST(Playback, StartsFreeBesideTheSurfaceAndTooDeepInside) {
  const Playback playback(sheet_model());
  for (const Eigen::Vector3d& start :
       {Eigen::Vector3d(51, 0, 705), {0, 0, 721}, {0, 0, 695}, {-60, -60, 701}}) {
    LoopState state;
    const Command command = playback.step(start, state);
    EXPECT_FALSE(command.started_inside) << start.transpose();
    EXPECT_EQ(command.state, ContactState::free);
  }
}

// A tick without a usable position, and what would be one of a device that jumps.
std::vector<Eigen::Vector3d> faults() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  return {{nan, 4, 705}, {3, infinity, 705}, {1e30, -1e30, 1e30}, {3, 4, 765}, {3, 10004, 705}};
}

TEST(Playback, KeepsTheContactThroughAFewFaultyTicksWithLessForce) {
  const Playback playback(sheet_model());
  for (const Eigen::Vector3d& fault : faults()) {
    LoopState state;
    static_cast<void>(playback.step(kAbove, state));
    const Command touching = playback.step({3, 4, 705}, state);
    Command last = touching;
    for (int i = 0; i < 5; ++i) {
      const Command command = playback.step(fault, state);
      EXPECT_TRUE(command.held);
      EXPECT_EQ(command.state, ContactState::stick);
      EXPECT_EQ(command.contact, touching.contact);
      EXPECT_LT(command.force.norm(), last.force.norm());
      EXPECT_GT(command.force.norm(), 0.5 * touching.force.norm());
      last = command;
    }
    for (int i = 0; i < 20; ++i) last = playback.step({3, 4, 705}, state);
    EXPECT_FALSE(last.held);
    EXPECT_EQ(last.contact, touching.contact);
    EXPECT_LT((last.force - touching.force).norm(), 1e-9);
  }
}

TEST(Playback, ForgetsTheContactAfterManyFaultyTicksAndStartsAgain) {
  const Model model = sheet_model();
  const double jump = *playback_options_for(model, {}).largest_jump;
  const Playback playback(model);
  for (const Eigen::Vector3d& fault : faults()) {
    LoopState state;
    static_cast<void>(playback.step(kAbove, state));
    Command command = playback.step({3, 4, 705}, state);
    for (int i = 0; i < 60; ++i) {
      const Eigen::Vector3d before = command.force;
      command = playback.step(fault, state);
      EXPECT_TRUE(command.contact.allFinite());
      EXPECT_LE((command.force - before).norm(), jump);
    }
    EXPECT_EQ(command.force, Eigen::Vector3d::Zero());
    EXPECT_EQ(command.state, ContactState::free);
    if (fault.allFinite()) continue;
    EXPECT_TRUE(playback.step({3, 4, 705}, state).started_inside);
  }
}

TEST(Playback, ForcesAreFiniteHoweverFarTheToolGoes) {
  const Playback playback(uneven_model());
  const Eigen::Matrix3Xd places = random_points(500, 1);
  LoopState state;
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    const double reach = std::pow(10.0, static_cast<double>(i % 12));
    const Command command =
        playback.step(Eigen::Vector3d(0, 0, 700) + reach * places.col(i), state);
    EXPECT_TRUE(command.force.allFinite());
    EXPECT_TRUE(command.contact.allFinite());
  }
}

TEST(PlaybackOnCreases, DoesNotFallThroughConcaveOnes) {
  for (const double slope : {0.3, 1.05, 2.0, 4.0, 7.0, 10.0}) {
    for (const double friction : {0.0, 0.05, 0.5, 1.5}) {
      const Playback playback(height_field_model(
          {.height = [&](double x, double) { return slope * std::abs(x); }, .friction = friction}));
      Hand hand(playback, {-6, 1, 6 * slope + 1});
      const double depth = 3 * std::sqrt(1 + slope * slope);  // of 3 mm perpendicular to each side
      hand.go({-6, 1, 6 * slope - depth}, 0.1);
      hand.free = 0;
      hand.go({0, 2, -depth}, 0.1);
      hand.go({6, 3, 6 * slope - depth}, 0.1);
      // The contact may be lost for a tick, in which the force goes on, and is found again.
      EXPECT_LE(hand.free, 1) << slope << ' ' << friction;
      EXPECT_GT(hand.last.force.norm(), 0.5) << slope << ' ' << friction;
    }
  }
}

TEST(PlaybackOnCreases, ForceDoesNotJumpOverConvexEdges) {
  for (const double slope : {0.5, 1.0, 2.0}) {
    for (const double friction : {0.05, 0.3, 1.0}) {
      const Playback playback(
          height_field_model({.height = [&](double x, double) { return -slope * std::abs(x); },
                              .friction = friction}));
      // Across below the edge, so that force builds up, and along one side and straight on, so that
      // the other side passes below the tool.
      const double below = -8 * slope - 3 * std::sqrt(1 + slope * slope);
      for (const double bend : {below, -3.0}) {
        Hand hand(playback, {-8, 1, -8 * slope + 1});
        const double start = std::max(below, -8 * slope + bend);
        hand.go({-8, 1, start}, kTick);
        hand.go({0, 1, bend}, kTick);
        hand.go({8, 1, bend}, kTick);
        EXPECT_LT(hand.largest_change, 0.2) << slope << ' ' << friction;
        EXPECT_GT(hand.largest_change, 0.01);
      }
    }
  }
}

TEST(PlaybackOnCreases, ForceEndsInARampAtTheBorder) {
  for (const double friction : {0.0, 0.3}) {
    const Playback playback(
        height_field_model({.height = waves, .friction = friction, .uneven = true}));
    for (const double angle : {0.0, 1.1, 2.4, 4.0}) {
      const Eigen::Vector3d along(std::cos(angle), std::sin(angle), 0);
      Hand hand(playback, 20 * along + 5 * Eigen::Vector3d::UnitZ());
      hand.go(20 * along - 4 * Eigen::Vector3d::UnitZ(), kTick);
      EXPECT_GT(hand.last.force.norm(), 0.1);
      hand.go(55 * along - 4 * Eigen::Vector3d::UnitZ(), kTick);
      EXPECT_LT(hand.largest_change, 0.2) << friction << ' ' << angle;
      EXPECT_EQ(hand.last.force, Eigen::Vector3d::Zero());
      EXPECT_EQ(hand.last.state, ContactState::free);
    }
  }
}

// The cones lean by 45 degrees towards the border at x = 30, so that the contact is 3 mm ahead of a
// tool 3 mm deep, and slips off while the tool is still behind the surface.
TEST(PlaybackAtBorders, KeepsToolsThatAreInsideThoughTheirContactSlipsOff) {
  for (const double friction : {0.0, 0.3}) {
    Model model =
        height_field_model({.height = [](double, double) { return 0.0; }, .friction = friction});
    for (ContactModel& contact : model.contacts) {
      contact.frame = rotation_exp({0, std::numbers::pi / 4, 0}) * contact.frame;
      contact.friction_axis = contact.frame.col(2);
    }
    const Playback playback(with_compliances(std::move(model), 1));
    Hand hand(playback, {20, 1, 1});
    hand.go({20, 1, -3}, kTick);
    hand.free = 0;
    hand.largest_change = 0;
    hand.go({29.9, 1, -3}, kTick);
    EXPECT_GT(hand.last.contact.x(), 29.8) << friction;
    EXPECT_EQ(hand.free, 0) << friction;
    EXPECT_GT(hand.last.force.norm(), 0.5) << friction;
    hand.go({33, 1, -3}, kTick);
    EXPECT_EQ(hand.last.state, ContactState::free) << friction;
    EXPECT_LT(hand.largest_change, 0.2) << friction;
  }
}

// A step of 1.5 mm whose side the camera has not seen: the way from the contact to the tool leads
// through the gap, and crosses nothing.
TEST(PlaybackAtBorders, KeepsToolsThatGoOnInsideBehindAGap) {
  Model model = height_field_model(
      {.height = [](double x, double) { return x < 0.5 ? 0.0 : 1.5; }, .friction = 6});
  geometry::TriangleMesh& surface = model.surface;
  Eigen::Matrix3Xi kept(3, 0);
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = surface.triangles.col(t);
    const auto z = [&](int k) { return surface.vertices(2, corners[k]); };
    if (z(0) != z(1) || z(1) != z(2)) continue;
    kept.conservativeResize(3, kept.cols() + 1);
    kept.rightCols<1>() = corners;
  }
  ASSERT_EQ(surface.triangles.cols() - kept.cols(), 2 * 60);
  surface.triangles = kept;
  const Playback playback(model);
  Hand hand(playback, {-0.5, 0.3, 1});
  hand.go({-0.5, 0.3, -1}, kTick);
  hand.free = 0;
  hand.go({2.2, 0.3, -1}, kTick);
  EXPECT_LT(hand.last.contact.x(), 0) << "it sticks on this side of the gap";
  hand.go({2.2, 0.3, 0.7}, kTick);
  EXPECT_EQ(hand.free, 0);
  EXPECT_NEAR(hand.last.contact.z(), 1.5, 1e-9);
  EXPECT_GT(hand.last.force.norm(), 0.3);
  hand.go({2.2, 0.3, 1.6}, kTick);
  EXPECT_EQ(hand.last.state, ContactState::free);
}

// On a depth camera's hand, along random ways 2 mm below the surface. A fall is the loss of a
// contact while the tool is inside and not beyond the border.
TEST(PlaybackOnCreases, DoesNotFallThroughAHand) {
  Model model = hand_model([](int i) { return i % 4 * 0.3; });
  const geometry::TriangleMesh mesh = model.surface;
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(mesh);
  const geometry::SurfaceQuery query(mesh);
  const std::vector<std::vector<int>> border = geometry::boundary_loops(mesh);
  const auto to_border = [&](const Eigen::Vector3d& place) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::vector<int>& loop : border) {
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const Eigen::Vector3d a = mesh.vertices.col(loop[i]);
        const Eigen::Vector3d ab = mesh.vertices.col(loop[(i + 1) % loop.size()]) - a;
        const double along = std::clamp((place - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
        nearest = std::min(nearest, (place - a - along * ab).norm());
      }
    }
    return nearest;
  };
  const Playback playback(std::move(model));
  std::mt19937 random(5);
  int touching = 0, left = 0, falls = 0;
  for (int way = 0; way < 100; ++way) {
    const auto triangle = static_cast<Eigen::Index>(random() % mesh.triangles.cols());
    const Eigen::Vector3d goal = mesh.vertices.col(random() % mesh.vertices.cols());
    const Eigen::Vector3d normal = normals.col(triangle);
    const Eigen::Vector3d start =
        geometry::position(mesh, {static_cast<int>(triangle), Eigen::Vector3d::Constant(1.0 / 3)});
    Hand hand(playback, start + normal);
    hand.go(start - 2 * normal, 0.1);
    for (int i = 0; i < 220; ++i) {
      const geometry::ClosestPoint next =
          query.closest_point(hand.tool + 0.1 * (goal - hand.tool).normalized());
      const Eigen::Vector3d to = next.position - 2 * normals.col(next.at.triangle) - hand.tool;
      const ContactState before = hand.last.state;
      hand.step(hand.tool + std::min(1.0, 0.15 / to.norm()) * to);
      touching += hand.last.state != ContactState::free;
      if (before == ContactState::free || hand.last.state != ContactState::free) continue;
      ++left;
      const geometry::ClosestPoint nearest = query.closest_point(hand.tool);
      const double depth = (nearest.position - hand.tool).dot(normals.col(nearest.at.triangle));
      falls += depth > 0.02 && to_border(nearest.position) > 1e-3;
    }
  }
  EXPECT_GT(touching, 10'000);
  EXPECT_GT(left, 0);
  EXPECT_EQ(falls, 0);
}

TEST(PlaybackSlip, EndsOnTheConeAfterJumpsAtAnyFriction) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const double friction : {0.0, 0.05, 0.2, 0.5, 3.0}) {
    const Playback playback(
        height_field_model({.height = waves, .friction = friction, .uneven = true}),
        {.energy_credit = std::numeric_limits<double>::infinity()});
    int slips = 0, beyond = 0, restless = 0;
    for (int i = 0; i < 300; ++i) {
      const double x = 15 * uniform(random), y = 15 * uniform(random);
      const double angle = 3.2 * uniform(random), jump = std::pow(10, uniform(random));
      LoopState state;
      static_cast<void>(playback.step({x, y, waves(x, y) + 1}, state));
      static_cast<void>(playback.step({x, y, waves(x, y) - 3}, state));
      const Eigen::Vector3d tool(x + jump * std::cos(angle), y + jump * std::sin(angle),
                                 waves(x, y) - 3);
      const Command command = playback.step(tool, state);
      if (command.state != ContactState::slip || command.limited) continue;
      ++slips;
      beyond += std::abs(friction_parts(state.place, -command.force).excess) > 1e-3;
      restless += playback.step(tool, state).state == ContactState::slip;
    }
    EXPECT_GT(slips, friction > 1 ? 5 : 100) << friction;
    EXPECT_LE(beyond, slips / 200) << friction;
    EXPECT_LE(restless, slips / 200) << friction;
  }
}

// Over steep hills a tool may leave through the other side. At high friction the way to the cone
// may begin anywhere.
TEST(PlaybackSlip, EndsOnTheConeOrOutsideAfterJumpsOverHills) {
  const auto hills = [](double x, double y) {
    return 6 * std::sin(x / 12.7) * std::cos(y / 9.5) + std::sin((x + 0.6 * y) / 4);
  };
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int slips = 0, left = 0;
  for (const double friction : {1.0, 2.0, 3.0}) {
    const Model model = height_field_model({.height = hills,
                                            .friction = friction,
                                            .uneven = true,
                                            .half_size = 50,
                                            .cells = 50,
                                            .grid = 6});
    const Playback playback(model, {.energy_credit = kInf, .largest_jump = kInf});
    const geometry::SurfaceQuery query(model.surface);
    const Eigen::Matrix3Xd normals = geometry::triangle_normals(model.surface);
    for (int i = 0; i < 1000; ++i) {
      const double x = 35 * uniform(random), y = 35 * uniform(random),
                   angle = std::numbers::pi * uniform(random);
      const geometry::ClosestPoint at = query.closest_point({x, y, hills(x, y)});
      const Eigen::Vector3d normal = normals.col(at.at.triangle);
      LoopState state;
      static_cast<void>(playback.step(at.position + normal, state));
      const Eigen::Vector3d pressed = at.position - 3 * normal;
      static_cast<void>(playback.step(pressed, state));
      const Eigen::Vector3d along = normal.unitOrthogonal() * std::cos(angle) +
                                    normal.cross(normal.unitOrthogonal()) * std::sin(angle);
      const Eigen::Vector3d tool = pressed + 10 * along;
      const Command command = playback.step(tool, state);
      if (command.state == ContactState::free) {
        ++left;
        const geometry::ClosestPoint nearest = query.closest_point(tool);
        EXPECT_GT((tool - nearest.position).dot(normals.col(nearest.at.triangle)), 0) << i;
      } else if (command.state == ContactState::slip) {
        ++slips;
        EXPECT_LE(std::abs(friction_parts(state.place, -command.force).excess), 1e-3)
            << friction << ' ' << i;
      }
    }
  }
  EXPECT_GT(slips, 1000);
  EXPECT_GT(left, 50);
}

// Presses, slides and lifts: the object must not do work on the user.
TEST(PlaybackSlip, GivesTheUserNoEnergy) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const double friction : {0.0, 0.1, 0.3, 1.0}) {
    const Playback playback(
        height_field_model({.height = waves, .friction = friction, .uneven = true}));
    double most = 0;
    for (int i = 0; i < 60; ++i) {
      const double x = 12 * uniform(random), y = 12 * uniform(random);
      const double angle = 3.2 * uniform(random), length = 7.5 * (1 + uniform(random));
      const Eigen::Vector3d above(x, y, waves(x, y) + 1);
      const Eigen::Vector3d away(length * std::cos(angle), length * std::sin(angle), 0);
      const Eigen::Vector3d pressed = above - (4 + uniform(random)) * Eigen::Vector3d::UnitZ();
      Hand hand(playback, above);
      hand.go(pressed, kTick);
      hand.go(pressed + away, kTick);
      hand.go(pressed + away + 12 * Eigen::Vector3d::UnitZ(), kTick);
      most = std::max(most, hand.work);
    }
    EXPECT_LT(most, 0.05) << friction;  // [N mm], that is mJ
  }
}

TEST(PlaybackSlip, ForceIsContinuousInTheToolsPosition) {
  const Playback playback(height_field_model({.height = waves, .uneven = true}));
  Hand hand(playback, {-9, 2, waves(-9, 2) + 0.5});
  hand.go({-9, 2, waves(-9, 2) - 3}, kTick);
  for (int i = 0; i < 2000; ++i) {
    const double x = -9 + 0.01 * i;
    hand.step({x, 2 + 0.003 * i, waves(x, 2 + 0.003 * i) - 3});
    LoopState copy = hand.state;
    const Command near = playback.step(hand.tool + Eigen::Vector3d(1e-3, 0, 0), copy);
    EXPECT_LT((near.force - hand.last.force).norm(), 5e-3);
  }
  EXPECT_GT(hand.slips, 1000);
}

TEST(PlaybackSlip, ThreeRulesAgreeWhereTheObjectIsTheSameEverywhere) {
  for (const ContactMotion motion :
       {ContactMotion::bracketed, ContactMotion::brent, ContactMotion::friction_boundary}) {
    const Playback playback(sheet_model(0.5), {.motion = motion});
    LoopState state;
    static_cast<void>(playback.step(kAbove, state));
    static_cast<void>(playback.step({3, 4, 705}, state));
    const Command command = playback.step({9, 4, 705}, state);
    EXPECT_EQ(command.state, ContactState::slip);
    EXPECT_NEAR(command.contact.x(), 6.5, 2e-3);
    EXPECT_NEAR(command.contact.y(), 4, 1e-6);
  }
}

TEST(Playback, RefusesBadOptions) {
  EXPECT_THAT(refusal([] { return Playback(sheet_model(), {.tolerance = 0}); }),
              ::testing::HasSubstr("PlaybackOptions::tolerance"));
  EXPECT_THAT(refusal([] { return Playback(sheet_model(), {.energy_credit = -1}); }),
              ::testing::HasSubstr("PlaybackOptions::energy_credit"));
  EXPECT_THAT(refusal([] { return Playback(sheet_model(), {.longest_step = -1}); }),
              ::testing::HasSubstr("PlaybackOptions::longest_step"));
  EXPECT_THAT(refusal([] { return Playback(sheet_model(), {.hold_ticks = -1}); }),
              ::testing::HasSubstr("PlaybackOptions::hold_ticks"));
}

TEST(Playback, LosesAContactThatPullsAndFindsItAgain) {
  Model model = sheet_model(0);
  // Weights below zero push the tool outwards less than nothing: the object pulls.
  for (ContactModel& contact : model.contacts) contact.field = scaled(contact.field, -1);
  const Playback playback(model);
  LoopState state;
  static_cast<void>(playback.step(kAbove, state));
  for (int i = 0; i < 3; ++i) {
    const Command command = playback.step({3, 4, 705}, state);
    EXPECT_EQ(command.state, ContactState::free);
    EXPECT_EQ(command.force, Eigen::Vector3d::Zero());
    EXPECT_TRUE(state.has_proxy);
    EXPECT_NEAR(state.proxy.position.z(), 700, 1e-3);
  }
}

TEST(Playback, IsTheSameOnEveryRunAndMovesWithTheWorld) {
  const std::vector<TrajectoryPoint> trajectory = some_trajectory();
  const std::vector<TracePoint> trace = play(Playback(uneven_model()), trajectory);
  const std::vector<TracePoint> again = play(Playback(uneven_model()), trajectory);
  const Eigen::Isometry3d motion = some_motion();
  std::vector<TrajectoryPoint> moved_trajectory = trajectory;
  for (TrajectoryPoint& point : moved_trajectory) point.tool = motion * point.tool;
  const std::vector<TracePoint> elsewhere =
      play(Playback(moved(uneven_model(), motion)), moved_trajectory);
  for (std::size_t i = 0; i < trace.size(); ++i) {
    EXPECT_EQ(trace[i].force, again[i].force);
    EXPECT_EQ(trace[i].contact, again[i].contact);
    // Slips end within the tolerance of the search.
    EXPECT_LT((elsewhere[i].force - motion.linear() * trace[i].force).norm(), 1e-3) << i;
  }
}

TEST(Playback, DoesNotAllocateInTheLoop) {
  if (!test::counts_allocations()) GTEST_SKIP() << "the sanitizer's allocator cannot be counted";
  for (const bool by_compliance : {false, true}) {
    const Model model = by_compliance ? with_compliances(uneven_model(), 2) : uneven_model();
    if (by_compliance) {
      ASSERT_TRUE(std::ranges::all_of(model.contacts, [](const ContactModel& contact) {
        return contact.compliance.has_value();
      }));
    }
    const Playback playback(model);
    const std::vector<TrajectoryPoint> trajectory = some_trajectory();
    LoopState state;
    const long before = test::allocations();
    int slips = 0, bad = 0;
    for (const TrajectoryPoint& point : trajectory)
      slips += playback.step(point.tool, state).state == ContactState::slip;
    // Jumps of 5 cm, places far away, and what is no place.
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-1, 1);
    Eigen::Vector3d tool(0, 0, 702);
    for (int i = 0; i < 20'000; ++i) {
      constexpr std::array<double, 5> reaches = {0.01, 1, 5, 50, 1e4};
      const double reach = reaches[random() % reaches.size()];
      tool = Eigen::Vector3d(0, 0, 702) +
             reach * Eigen::Vector3d{uniform(random), uniform(random), uniform(random)};
      if (random() % 50 == 0) tool.x() = std::numeric_limits<double>::quiet_NaN();
      if (random() % 50 == 0) tool.z() = std::numeric_limits<double>::infinity();
      bad += !playback.step(tool, state).force.allFinite();
    }
    EXPECT_EQ(test::allocations(), before);
    EXPECT_GT(slips, 100);
    EXPECT_EQ(bad, 0);
  }
}

}  // namespace
}  // namespace palpate::haptics
