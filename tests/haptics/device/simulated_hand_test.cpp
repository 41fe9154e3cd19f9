// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/simulated_hand.h"

#include <gtest/gtest.h>

#include <cmath>

#include "refusal.h"

namespace palpate::haptics {
namespace {

TimedPath rest() { return TimedPath({{0, Eigen::Vector3d::Zero()}}); }

TEST(SimulatedHand, FallsFreely) {
  SimulatedHand hand(
      rest(), {.mass = 0.1, .damping = 0, .stiffness = 0, .push = {0, 0, -1}, .encoder_step = 0});
  devices::DeviceState state;
  for (int tick = 1; tick <= 100; ++tick) {
    ASSERT_TRUE(hand.read(state));
    const double time = 1e-3 * tick;
    EXPECT_NEAR(state.tip.z(), -0.5 * 1e4 * time * time, 1e-9);
    EXPECT_NEAR(state.time, time, 1e-12);
  }
}

TEST(SimulatedHand, SwingsAsADampedOscillator) {
  const HandOptions options{
      .mass = 0.2, .damping = 0.003, .stiffness = 0.1, .push = {0.5, 0, 0}, .encoder_step = 0};
  SimulatedHand hand(rest(), options);
  const double mass = 1e-3 * options.mass;
  const double decay = options.damping / (2 * mass);
  const double turn = std::sqrt(options.stiffness / mass - decay * decay);
  devices::DeviceState state;
  for (int tick = 1; tick <= 500; ++tick) {
    ASSERT_TRUE(hand.read(state));
    const double time = 1e-3 * tick;
    const double expected =
        5 * (1 - std::exp(-decay * time) *
                     (std::cos(turn * time) + decay / turn * std::sin(turn * time)));
    EXPECT_NEAR(state.tip.x(), expected, 1e-8) << tick;
  }
}

TEST(SimulatedHand, IsHeldByFrictionUpToItsForce) {
  for (const double push : {0.09, 0.11}) {
    SimulatedHand hand(rest(),
                       {.friction = 0.1, .stiffness = 0, .push = {0, 0.6 * push, 0.8 * push}});
    devices::DeviceState state;
    for (int tick = 0; tick < 100; ++tick) ASSERT_TRUE(hand.read(state));
    EXPECT_EQ(hand.position().norm() > 0, push > 0.1) << push;
  }
}

TEST(SimulatedHand, StopsByFrictionAfterTheWayThatItsEnergyLasts) {
  // Thrown by 1 N for 0.1 s, without damping: 25 mm, and 250 mm/s; then m v^2 / (2 c) on.
  constexpr double kMass = 0.4, kFriction = 0.05;
  const HandOptions options{.mass = kMass,
                            .damping = 0,
                            .friction = kFriction,
                            .stiffness = 0,
                            .encoder_step = 0,
                            .delay = 0};
  SimulatedHand hand(rest(), options);
  hand.activate();
  devices::DeviceState state;
  for (int tick = 0; tick < 2500; ++tick) {
    if (tick < 100) {
      ASSERT_TRUE(
          hand.write({.force = {0.6 * (1 + kFriction), 0, 0.8 * (1 + kFriction)}, .lease = 1e-3}));
    }
    ASSERT_TRUE(hand.read(state));
  }
  const double thrown = 1e3 / kMass * 0.1 * 0.1 / 2, speed = 1e3 / kMass * 0.1;
  const double way = thrown + 1e-3 * kMass * speed * speed / (2 * kFriction);
  EXPECT_NEAR(hand.position().norm(), way, 1e-3 * way);
  const Eigen::Vector3d there = hand.position();
  ASSERT_TRUE(hand.read(state));
  EXPECT_EQ(hand.position(), there) << "it is at rest";
}

TEST(SimulatedHand, FollowsItsWish) {
  SimulatedHand hand(TimedPath({{0, {0, 0, 0}}, {1, {20, 0, 0}}}, PathShape::smooth));
  devices::DeviceState state;
  for (int tick = 0; tick < 1500; ++tick) ASSERT_TRUE(hand.read(state));
  EXPECT_NEAR(state.tip.x(), 20, 0.05);
}

TEST(SimulatedHand, FeelsAForceAfterItsDelay) {
  for (const int delay : {0, 1, 4}) {
    SimulatedHand hand(rest(), {.delay = delay});
    EXPECT_EQ(hand.description().delay, 1e-3 * delay);
    hand.activate();
    devices::DeviceState state;
    ASSERT_TRUE(hand.read(state));
    for (int tick = 0; tick < 10; ++tick) {
      ASSERT_TRUE(hand.write({.force = {0, 0, 1.0 + tick}}));
      ASSERT_TRUE(hand.read(state));
      EXPECT_EQ(hand.applied_force().z(), tick < delay ? 0 : 1.0 + tick - delay) << delay;
    }
  }
}

// The watchdog that every device has: it needs no loop.
TEST(SimulatedHand, DropsTheForceWhenTheLeaseEnds) {
  SimulatedHand hand(rest(), {.delay = 1});
  hand.activate();
  devices::DeviceState state;
  ASSERT_TRUE(hand.read(state));
  ASSERT_TRUE(hand.write({.force = {0, 0, 1}, .lease = 0.01}));
  int felt = 0;
  for (int tick = 0; tick < 40; ++tick) {
    ASSERT_TRUE(hand.read(state));
    felt += hand.applied_force().z() == 1;
    if (tick > 12) {
      EXPECT_EQ(hand.applied_force().z(), 0) << tick;
    }
  }
  EXPECT_EQ(felt, 10);
}

TEST(SimulatedHand, ReadsQuantisedEncoders) {
  SimulatedHand hand(rest(), {.push = {0.3, 0, 0}, .encoder_step = 0.05});
  devices::DeviceState state;
  for (int tick = 0; tick < 100; ++tick) {
    ASSERT_TRUE(hand.read(state));
    EXPECT_NEAR(state.tip.x() / 0.05, std::round(state.tip.x() / 0.05), 1e-9);
    EXPECT_LE(std::abs(state.tip.x() - hand.position().x()), 0.025 + 1e-12);
  }
}

TEST(SimulatedHand, FeelsNothingUnlessItIsArmed) {
  SimulatedHand hand(rest(), {.delay = 0});
  EXPECT_FALSE(hand.write({.force = {0, 0, 1}}));
  hand.activate();
  ASSERT_TRUE(hand.write({.force = {0, 0, 1}}));
  hand.stop();
  devices::DeviceState state;
  ASSERT_TRUE(hand.read(state));
  EXPECT_EQ(hand.applied_force(), Eigen::Vector3d::Zero());
}

TEST(SimulatedHand, RefusesWhatCannotBe) {
  const auto message = [](const HandOptions& options) {
    return refusal([&] { return SimulatedHand(rest(), options).now(); });
  };
  EXPECT_NE(message({.mass = 0}).find("HandOptions::mass"), std::string::npos);
  EXPECT_NE(message({.damping = -1}).find("HandOptions::damping"), std::string::npos);
  EXPECT_NE(message({.friction = -1}).find("HandOptions::friction"), std::string::npos);
  EXPECT_NE(message({.stiffness = std::nan("")}).find("HandOptions::stiffness"), std::string::npos);
  EXPECT_NE(message({.push = {std::nan(""), 0, 0}}).find("HandOptions::push"), std::string::npos);
  EXPECT_NE(message({.delay = 17}).find("HandOptions::delay"), std::string::npos);
}

}  // namespace
}  // namespace palpate::haptics
