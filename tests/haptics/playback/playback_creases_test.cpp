// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "crease_model.h"
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
        EXPECT_FALSE(hand.last.force.isZero(0)) << kOpenings[groove] << ' ' << friction;
      }
    }
  }
}

}  // namespace
}  // namespace palpate::haptics
