// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "crease_model.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/playback.h"
#include "playback_hand.h"

namespace palpate::haptics {
namespace {

const std::vector<double> kOpenings = {20, 30, 45, 60, 90};  // [degrees]

class PlaybackInGrooves : public ::testing::Test {
 protected:
  const CreaseProfile profile{kOpenings};
  const Model model = crease_model({.openings = kOpenings, .width = 40});
  const geometry::SurfaceQuery query{model.surface};

  [[nodiscard]] Model with_friction(double friction) const {
    Model copy = model;
    for (ContactModel& contact : copy.contacts) contact.friction = friction;
    return copy;
  }
};

// From one flank round the bottom to the other, at the same depth behind the surface.
TEST_F(PlaybackInGrooves, KeepTheForceOfAToolThatPassesBelowTheBottom) {
  for (const double friction : {0.0, 0.05, 0.3, 0.9}) {
    const Playback playback(with_friction(friction));
    for (std::size_t groove = 0; groove < kOpenings.size(); ++groove) {
      const double half = kOpenings[groove] / 2 * std::numbers::pi / 180;
      for (const double depth : {0.5, 1.5, 3.0}) {
        // Angles from one flank's outward direction to the other's, seen from the bottom.
        const auto place = [&](double angle, double along_flank) {
          const Eigen::Vector3d bottom(profile.bottom(groove), 2 * depth, -CreaseProfile::kDepth);
          const double side = angle < std::numbers::pi / 2 ? -1 : 1;
          return Eigen::Vector3d(
              bottom + along_flank * Eigen::Vector3d(side * std::sin(half), 0, std::cos(half)) +
              depth * Eigen::Vector3d(-std::cos(angle), 0, -std::sin(angle)));
        };
        constexpr double kStep = 0.1, kHeight = 3;  // [mm]
        const double last = std::numbers::pi - half;
        Hand hand(playback, {profile.bottom(groove), 2 * depth, -4});
        hand.go(place(half, kHeight), kStep);
        ASSERT_NE(hand.last.state, ContactState::free);
        hand.free = 0;
        hand.go(place(half, 0), kStep);
        for (double angle = half; angle < last; angle += kStep / depth) hand.step(place(angle, 0));
        hand.go(place(last, kHeight), kStep);
        EXPECT_EQ(hand.free, 0) << kOpenings[groove] << ' ' << friction << ' ' << depth;
        EXPECT_FALSE(hand.last.force.isZero(0)) << kOpenings[groove] << ' ' << friction;
      }
    }
  }
}

// A place in front of the surface, at least 10 mm from the border, and one behind it.
struct Pressing {
  Eigen::Vector3d outside, pressed, along;
};

// \param depth [mm].
// \param highest [mm] z of the place; the bottoms of grooves are at -8.
Pressing random_pressing(const Model& model, const geometry::SurfaceQuery& query,
                         const CreaseProfile& profile, double depth, std::mt19937& random,
                         double highest = 0) {
  const geometry::TriangleMesh& surface = model.surface;
  std::uniform_real_distribution<double> uniform(-1, 1);
  while (true) {
    constexpr double kFromBorder = 10;  // [mm]
    const int triangle = static_cast<int>(random() % surface.triangles.cols());
    const Eigen::Vector3d place =
        geometry::position(surface, {triangle, Eigen::Vector3d::Constant(1.0 / 3)});
    if (place.z() > highest || place.x() < kFromBorder ||
        place.x() > profile.corners().back().x() - kFromBorder ||
        std::abs(place.y()) > 20 - kFromBorder)
      continue;
    const Eigen::Vector3i corners = surface.triangles.col(triangle);
    const Eigen::Vector3d from = surface.vertices.col(corners[0]);
    const Eigen::Vector3d normal = (surface.vertices.col(corners[1]) - from)
                                       .cross(surface.vertices.col(corners[2]) - from)
                                       .normalized();
    const auto opposite = query.first_hit(place + 1e-6 * normal, place + 2 * normal);
    const double free = opposite ? (opposite->position - place).norm() / 2 : 1;
    const Eigen::Vector3d any{uniform(random), uniform(random), uniform(random)};
    return {place + free * normal, place - depth * normal,
            (any - any.dot(normal) * normal).normalized()};
  }
}

TEST_F(PlaybackInGrooves, EndSlipsOnTheConeAfterJumps) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const double friction : {0.0, 0.1, 0.3}) {
    const Playback playback(with_friction(friction),
                            {.energy_credit = kInfinite, .largest_jump = kInfinite});
    std::mt19937 random(7);
    int slips = 0, beyond = 0;
    for (int i = 0; i < 150; ++i) {
      const Pressing at = random_pressing(model, query, profile, 3, random);
      LoopState state;
      static_cast<void>(playback.step(at.outside, state));
      static_cast<void>(playback.step(at.pressed, state));
      constexpr std::array kJumps = {0.3, 2.0, 10.0};  // [mm]
      const Command command =
          playback.step(at.pressed + kJumps[static_cast<std::size_t>(i % 3)] * at.along, state);
      if (command.state != ContactState::slip) continue;
      ++slips;
      const FrictionParts parts = friction_parts(state.place, -command.force);
      beyond += !(parts.normal >= 0 && std::abs(parts.excess) <= 1e-3);
    }
    EXPECT_GT(slips, 70) << friction;
    EXPECT_EQ(beyond, 0) << friction;
  }
}

// There the cone is that of neither flank, so that the nearest place may pull. A press straight
// along the normal slips, too, if the cone leans: as seen along a normal, the tool is then nowhere
// aside.
TEST_F(PlaybackInGrooves, EndSlipsOnTheConeNearTheBottom) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const double friction : {0.0, 0.2, 0.5, 1.0}) {
    const Playback playback(with_friction(friction),
                            {.energy_credit = kInfinite, .largest_jump = kInfinite});
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0, 1);
    int slips = 0, presses = 0;
    for (int i = 0; i < 600; ++i) {
      const double highest = -CreaseProfile::kDepth + 2;
      const Pressing at =
          random_pressing(model, query, profile, 4 * uniform(random), random, highest);
      LoopState state;
      static_cast<void>(playback.step(at.outside, state));
      for (const double jump : {0.0, 0.3}) {  // [mm]
        const Command command = playback.step(at.pressed + jump * at.along, state);
        if (command.state != ContactState::slip) continue;
        ++(jump > 0 ? slips : presses);
        const FrictionParts parts = friction_parts(state.place, -command.force);
        EXPECT_GE(parts.normal, 0) << friction << ' ' << i << ' ' << jump;
        EXPECT_LE(std::abs(parts.excess), 1e-3) << friction << ' ' << i << ' ' << jump;
      }
    }
    EXPECT_GT(slips, 100) << friction;
    EXPECT_GT(presses, 100) << friction;
  }
}

// Presses, slides and lifts. \return [N mm] that the user gained.
double work_of_loop(Hand& hand, const Pressing& at, double length) {
  const double before = hand.work;
  const Eigen::Vector3d end = at.pressed + length * at.along;
  hand.go(at.outside, kTick);
  hand.go(at.pressed, kTick);
  hand.go(end, kTick);
  hand.go(end + 25 * Eigen::Vector3d::UnitZ(), kTick);
  return hand.work - before;
}

// Of the loops that return the whole credit, one is repeated: the way back leads through the air.
TEST_F(PlaybackInGrooves, GiveTheUserTheCreditOnlyOnce) {
  constexpr double kCredit = 0.04;  // [N mm]
  const Playback playback(with_friction(0), {.energy_credit = kCredit});
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::optional<Pressing> best;
  double length = 0, most = 0;
  for (int i = 0; i < 60; ++i) {
    const Pressing at = random_pressing(model, query, profile, 0.5 + 4.5 * uniform(random), random);
    const double slide = 10 * uniform(random);
    Hand hand(playback, at.outside);
    const double work = work_of_loop(hand, at, slide);
    EXPECT_LT(work, 0.05);  // [N mm]
    if (!hand.last.force.isZero(0) || work <= most) continue;
    most = work;
    best = at;
    length = slide;
  }
  ASSERT_GT(most, 0.03);
  Hand hand(playback, best->outside);
  constexpr int kTouches = 8;
  for (int i = 0; i < kTouches; ++i) {
    work_of_loop(hand, *best, length);
    const Eigen::Vector3d above(best->outside.x(), best->outside.y(), 25);
    hand.go(above, kTick);
    hand.go(best->outside, kTick);
  }
  // The credit, and a tenth of it for each later touch.
  EXPECT_LT(hand.work, kCredit * (1 + 0.1 * (kTouches - 1)) + 0.005);
}

// Ways through a groove leave the object and touch it again.
TEST_F(PlaybackInGrooves, GiveTheUserAtMostTheCreditAtAnyFriction) {
  for (const double friction : {0.0, 0.05, 0.1, 0.2, 0.5, 1.0}) {
    const Playback playback(with_friction(friction));
    std::mt19937 random(17);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int i = 0; i < 50; ++i) {
      const double highest = -CreaseProfile::kDepth + 2.5;
      const Pressing at =
          random_pressing(model, query, profile, 2.5 + 2 * uniform(random), random, highest);
      Hand hand(playback, at.outside);
      hand.go(at.pressed, kTick);
      for (int leg = 0; leg < 3; ++leg) {
        const Eigen::Vector3d way{uniform(random), uniform(random), uniform(random)};
        hand.go(hand.tool + 4 * way, kTick);
      }
      hand.go(hand.tool + 30 * Eigen::Vector3d::UnitZ(), kTick);
      EXPECT_TRUE(hand.last.force.isZero(0)) << friction << ' ' << i;
      EXPECT_LT(hand.work, 0.05) << friction << ' ' << i;  // [N mm]
    }
  }
}

// A fitted field is far stiffer where no one has pressed than where one has.
TEST_F(PlaybackInGrooves, ChangeTheForceByTheStiffnessThatIsFelt) {
  constexpr double kStiffness = 2, kFarAway = 40, kFarWeight = 4, kFarEpsilon = 0.2;
  Model stiff = model;
  for (ContactModel& contact : stiff.contacts) {
    contact.field.bases.push_back({kFarWeight, kFarEpsilon, {0, 0, kFarAway}});
  }
  constexpr double kDepth = 5;  // [mm]
  const double added = kFarWeight / (kFarAway - 2 * kDepth);
  const double jump = *playback_options_for(stiff, {}).largest_jump;
  const double most = jump + (kStiffness + added) * kTick;
  ASSERT_LT(most, 0.2);
  int limited = 0;
  for (const double friction : {0.05, 0.5}) {
    for (ContactModel& contact : stiff.contacts) contact.friction = friction;
    const Playback playback(stiff);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < 100; ++i) {
      const Pressing at = random_pressing(model, query, profile, kDepth * uniform(random), random);
      Hand hand(playback, at.outside);
      work_of_loop(hand, at, 15 * uniform(random));
      EXPECT_LE(hand.largest_change, most) << friction << ' ' << i;
      limited += hand.largest_change > jump;
    }
  }
  EXPECT_GT(limited, 0);
}

}  // namespace
}  // namespace palpate::haptics
