// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/passivity_observer.h"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::haptics {
namespace {

TEST(PassivityObserver, CountsWhatAnActiveSpringGives) {
  // Pressed against 1 N/mm by 2 mm, released against twice the force: 2 N mm in, 4 out. The force
  // is that at the beginning of each step, as a held one is.
  PassivityObserver observer;
  constexpr double kStep = 1e-3;
  double depth = 0;
  for (; depth < 2; depth += kStep) observer.observe({0, 0, -depth}, {0, 0, depth});
  EXPECT_NEAR(observer.given().now, -2, 0.01);
  for (; depth > 0; depth -= kStep) observer.observe({0, 0, -depth}, {0, 0, 2 * depth});
  observer.observe({0, 0, 0}, Eigen::Vector3d::Zero());
  EXPECT_NEAR(observer.given().in_touches, 2, 0.02);
  EXPECT_NEAR(observer.given().largest, 2, 0.02);
  EXPECT_EQ(observer.given().touches, 1);
  EXPECT_EQ(observer.given().giving, 1);
}

TEST(PassivityObserver, SeesThatAHeldSpringGivesByItsDelay) {
  // A spring K x sampled at T that is pressed and released at speed v gives K v^2 T t: the area
  // between the staircase and the line, both ways (Colgate and Schenkel).
  PassivityObserver observer;
  constexpr int kTicks = 1000;
  constexpr double kStep = 2e-3;  // [mm] v T
  const auto at = [&](int tick) { return kStep * (kTicks - std::abs(kTicks - tick)); };
  for (int tick = 0; tick <= 2 * kTicks; ++tick) {
    observer.observe({0, 0, -at(tick)}, {0, 0, at(tick)});
  }
  EXPECT_NEAR(observer.given().in_touches, kTicks * kStep * kStep, 1e-9);
}

TEST(PassivityObserver, SeesNothingInAnObjectThatTakesEnergy) {
  PassivityObserver observer;
  for (int touch = 0; touch < 3; ++touch) {
    for (int tick = 0; tick <= 200; ++tick) {
      const double speed = tick < 100 ? 1 : -1;
      const double depth = 0.01 * (tick < 100 ? tick : 200 - tick);
      observer.observe({0, 0, -depth}, {0, 0, tick == 0 || tick == 200 ? 0 : 1 + 0.5 * speed});
    }
  }
  EXPECT_EQ(observer.given().touches, 3);
  EXPECT_EQ(observer.given().giving, 0);
  EXPECT_EQ(observer.given().in_touches, 0);
}

}  // namespace
}  // namespace palpate::haptics
