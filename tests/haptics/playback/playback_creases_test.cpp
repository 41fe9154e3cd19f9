// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
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
        EXPECT_GT(hand.last.force.norm(), 0.1) << kOpenings[groove] << ' ' << friction;
      }
    }
  }
}

// A place in front of a groove's flank or of the flat part, and one behind it.
struct Pressing {
  Eigen::Vector3d outside, pressed, along;
};

// At least 10 mm from the border. \param depth [mm].
Pressing random_pressing(const Model& model, const geometry::SurfaceQuery& query, double depth,
                         std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(model.surface);
  const Eigen::Vector3d most = model.surface.vertices.rowwise().maxCoeff(),
                        least = model.surface.vertices.rowwise().minCoeff();
  while (true) {
    constexpr double kFromBorder = 10;  // [mm]
    const int triangle = static_cast<int>(random() % model.surface.triangles.cols());
    const Eigen::Vector3d place =
        geometry::position(model.surface, {triangle, Eigen::Vector3d::Constant(1.0 / 3)});
    if (place.x() < least.x() + kFromBorder || place.x() > most.x() - kFromBorder ||
        std::abs(place.y()) > most.y() - kFromBorder) {
      continue;
    }
    const Eigen::Vector3d normal = normals.col(triangle);
    const auto opposite = query.first_hit(place + 1e-6 * normal, place + 2 * normal);
    const double free = opposite ? (opposite->position - place).norm() / 2 : 1;
    const Eigen::Vector3d any(uniform(random), uniform(random), uniform(random));
    return {place + free * normal, place - depth * normal,
            (any - any.dot(normal) * normal).normalized()};
  }
}

// Presses, slides through grooves and lifts off.
TEST_F(PlaybackInGrooves, GiveTheUserNoEnergy) {
  const geometry::SurfaceQuery query(model.surface);
  for (const double friction : {0.0, 0.05, 0.2, 0.5, 1.0}) {
    const Playback playback(with_friction(friction));
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(0, 1);
    double most = 0;
    int loops = 0;
    for (int i = 0; i < 60; ++i) {
      const Pressing at = random_pressing(model, query, 0.5 + 4.5 * uniform(random), random);
      const double length = 15 * uniform(random);
      Hand hand(playback, at.outside);
      hand.go(at.pressed, kTick);
      hand.go(at.pressed + length * at.along, kTick);
      hand.go(at.pressed + length * at.along + 25 * Eigen::Vector3d::UnitZ(), kTick);
      if (!hand.last.force.isZero(0)) continue;
      ++loops;
      most = std::max(most, hand.work);
    }
    EXPECT_LT(most, 0.05) << friction;  // [N mm], that is mJ
    EXPECT_GT(loops, 50);
  }
}

TEST_F(PlaybackInGrooves, LetSlipsEndOnTheConeAfterJumps) {
  const geometry::SurfaceQuery query(model.surface);
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const double friction : {0.05, 0.3}) {
    const Playback playback(with_friction(friction),
                            {.energy_credit = kInfinite, .largest_jump = kInfinite});
    std::mt19937 random(7);
    int slips = 0, beyond = 0;
    for (int i = 0; i < 600; ++i) {
      const Pressing at = random_pressing(model, query, 3, random);
      LoopState state;
      static_cast<void>(playback.step(at.outside, state));
      static_cast<void>(playback.step(at.pressed, state));
      const double jump = i % 3 == 0 ? 0.3 : i % 3 == 1 ? 2 : 10;
      const Command command = playback.step(at.pressed + jump * at.along, state);
      if (command.state != ContactState::slip) continue;
      ++slips;
      beyond += std::abs(friction_parts(state.place, -command.force).excess) > 1e-3;
    }
    EXPECT_GT(slips, 300);
    EXPECT_LE(beyond, 0) << friction;
  }
}

}  // namespace
}  // namespace palpate::haptics
