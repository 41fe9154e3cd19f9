// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/devices/safety_filter.h"
#include "not_finite.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "refusal.h"

namespace palpate::devices {
namespace {

constexpr double kTick = 1e-3;

bool has(const SafeCommand& command, SafetyAction action) {
  return (command.actions & static_cast<std::uint32_t>(action)) != 0;
}

/// A filter in use at 1 kHz.
class Loop {
 public:
  explicit Loop(const SafetyOptions& options = {}) : filter_(options) {}

  SafeCommand tick(const Eigen::Vector3d& force, SafetyInput input = {}) {
    now += kTick;
    input.now = now;
    input.state_time += now;
    input.force = force;
    return filter_.filter(input);
  }
  SafeCommand after(int ticks, const Eigen::Vector3d& force) {
    SafeCommand command;
    for (int i = 0; i < ticks; ++i) command = tick(force);
    return command;
  }
  double now = 5;

 private:
  SafetyFilter filter_;
};

TEST(SafetyFilter, LetsAForceThroughThatIsSafe) {
  Loop loop;
  const SafeCommand command = loop.after(600, {1, -0.5, 0.2});
  EXPECT_EQ(command.force, Eigen::Vector3d(1, -0.5, 0.2));
  EXPECT_EQ(command.actions, 0U);
}

TEST(SafetyFilter, GrowsFromZeroAtTheStart) {
  Loop loop({.ramp = 0.5});
  double last = 0;
  for (int i = 0; i < 500; ++i) {
    const SafeCommand command = loop.tick({0, 0, 2});  // a tool that starts deep inside
    EXPECT_NEAR(command.force.z(), 2 * i / 500.0, 1e-9);
    EXPECT_TRUE(has(command, SafetyAction::ramped));
    EXPECT_LT(command.force.z() - last, 0.0041);
    last = command.force.z();
  }
  EXPECT_FALSE(has(loop.tick({0, 0, 2}), SafetyAction::ramped));
}

TEST(SafetyFilter, ShortensALongForce) {
  Loop loop({.max_force = 2});
  const SafeCommand command = loop.after(600, {30, 40, 0});
  EXPECT_LT((command.force - Eigen::Vector3d(1.2, 1.6, 0)).norm(), 1e-12);
  EXPECT_TRUE(has(command, SafetyAction::clamped));
  EXPECT_LT((loop.tick({1e300, 1e300, 0}).force).norm(), 2 + 1e-12);
}

TEST(SafetyFilter, LimitsHowFastAForceGrowsButNotHowFastItFalls) {
  Loop loop({.slew = 100});
  EXPECT_EQ(loop.after(600, {0, 0, 0}).actions, 0U);
  SafeCommand command = loop.tick({0, 0, 1});
  EXPECT_NEAR(command.force.z(), 0.1, 1e-9);
  EXPECT_TRUE(has(command, SafetyAction::slewed));
  command = loop.tick({0, 0, 1});
  EXPECT_NEAR(command.force.z(), 0.2, 1e-9);
  command = loop.tick({0, 0, 0.05});  // at once
  EXPECT_NEAR(command.force.z(), 0.05, 1e-9);
  EXPECT_EQ(command.actions, 0U);
  EXPECT_NEAR(loop.after(100, {0, 0, 1}).force.z(), 1, 1e-9);
  command = loop.tick({0, 0, -1});  // to zero at once, then as slowly as from rest
  EXPECT_NEAR(command.force.z(), -0.1, 1e-9);
}

TEST(SafetyFilter, MakesNanAndInfinityZero) {
  for (const double wrong : {kNaN, std::numeric_limits<double>::infinity()}) {
    Loop loop;
    EXPECT_GT(loop.after(600, {0, 0, 1}).force.z(), 0.99);
    SafeCommand command = loop.tick({0, wrong, 1});
    EXPECT_EQ(command.force, Eigen::Vector3d::Zero());
    EXPECT_TRUE(has(command, SafetyAction::force_not_finite));
    command = loop.tick({0, 0, 1});
    EXPECT_EQ(command.force, Eigen::Vector3d::Zero()) << "the ramp begins";
    EXPECT_NEAR(loop.after(250, {0, 0, 1}).force.z(), 0.5, 1e-6);
  }
}

TEST(SafetyFilter, IsZeroForEachFaultInTheSameTickAndRampsAfterIt) {
  struct Fault {
    SafetyInput input;
    SafetyAction action;
  };
  const Fault faults[] = {
      {{.answered = false}, SafetyAction::no_answer},
      {{.finite = false}, SafetyAction::state_not_finite},
      {{.state_time = -0.021}, SafetyAction::stale},
      {{.state_time = 0.021}, SafetyAction::stale},
      {{.state_time = kNaN}, SafetyAction::stale},
      {{.armed = false}, SafetyAction::disarmed},
  };
  for (const Fault& fault : faults) {
    Loop loop;
    EXPECT_GT(loop.after(600, {0, 0, 1}).force.z(), 0.99);
    const SafeCommand command = loop.tick({0, 0, 1}, fault.input);
    EXPECT_EQ(command.force, Eigen::Vector3d::Zero());
    EXPECT_TRUE(has(command, fault.action)) << to_words(command.actions);
    EXPECT_LT(loop.after(10, {0, 0, 1}).force.z(), 0.02);
    EXPECT_NEAR(loop.after(600, {0, 0, 1}).force.z(), 1, 1e-12);
  }
}

TEST(SafetyFilter, IsZeroAfterAStallOfTheLoop) {
  Loop loop;
  EXPECT_GT(loop.after(600, {0, 0, 1}).force.z(), 0.99);
  loop.now += 0.03;
  const SafeCommand command = loop.tick({0, 0, 1});
  EXPECT_EQ(command.force, Eigen::Vector3d::Zero());
  EXPECT_TRUE(has(command, SafetyAction::late));
  EXPECT_NEAR(loop.after(251, {0, 0, 1}).force.z(), 0.5, 1e-6);
}

TEST(SafetyFilter, IsZeroForACommandThatTookTooLong) {
  SafetyFilter filter;
  SafeCommand command{.force = {0, 0, 1}};
  filter.check_age(0.009, command);
  EXPECT_EQ(command.force.z(), 1);
  filter.check_age(0.011, command);
  EXPECT_EQ(command.force, Eigen::Vector3d::Zero());
  EXPECT_TRUE(has(command, SafetyAction::late));
}

TEST(SafetyFilter, FadesFromOneModelToTheNext) {
  Loop loop({.crossfade = 0.05});
  EXPECT_NEAR(loop.after(600, {0, 0, 1}).force.z(), 1, 1e-12);
  EXPECT_NEAR(loop.tick({0, 0, 2}, {.crossfade = true}).force.z(), 1, 1e-12);
  EXPECT_NEAR(loop.after(25, {0, 0, 2}).force.z(), 1.5, 1e-9);
  EXPECT_NEAR(loop.after(25, {0, 0, 2}).force.z(), 2, 1e-9);
}

// The tool may be deep inside after a start or a fault, whatever the model.
TEST(SafetyFilter, DoesNotEndARampEarlierByAnotherModel) {
  Loop loop({.ramp = 0.5, .crossfade = 0.05});
  EXPECT_NEAR(loop.after(101, {0, 0, 2}).force.z(), 0.4, 1e-9);
  EXPECT_NEAR(loop.tick({0, 0, 3}, {.crossfade = true}).force.z(), 0.4, 1e-9);
  // The rest of the ramp: from 0.4 N to 3 N in 399 ticks.
  EXPECT_NEAR(loop.after(100, {0, 0, 3}).force.z(), 0.4 + 2.6 * 100 / 399, 1e-9);
  EXPECT_NEAR(loop.after(299, {0, 0, 3}).force.z(), 3, 1e-9);
}

// Heated by F^2 from cold, the motors reach 0.9 of the heat of 2 N after
// -10 s ln(1 - 0.9 (2 N / 3.3 N)^2) = 4.02 s.
TEST(SafetyFilter, BringsAForceAboveTheContinuousOneDownBeforeTheMotorsAreTooHot) {
  Loop loop({.max_force = 3.3, .ramp = 1e-3, .heating_time = 10, .continuous_force = 2});
  double heat = 0, last = 0, begun = 0, largest_heat = 0;
  for (int i = 0; i < 60'000; ++i) {
    const SafeCommand command = loop.tick({0, 0, 5});
    const double force = command.force.norm();
    heat += (1 - std::exp(-kTick / 10)) * (force * force / 4 - heat);
    largest_heat = std::max(largest_heat, heat);
    if (begun == 0 && has(command, SafetyAction::heated)) begun = kTick * i;
    if (i > 10) {
      EXPECT_LT(last - force, 3e-3) << "no jump, at tick " << i;
    }
    last = force;
  }
  EXPECT_NEAR(begun, -10 * std::log(1 - 0.9 * 4 / (3.3 * 3.3)), 0.02);
  EXPECT_NEAR(last, 2, 1e-3);
  EXPECT_LT(largest_heat, 1 + 1e-9);
  EXPECT_GT(largest_heat, 0.99);
  // After a rest of two time constants there is room again.
  for (int i = 0; i < 20'000; ++i) static_cast<void>(loop.tick(Eigen::Vector3d::Zero()));
  EXPECT_NEAR(loop.after(100, {0, 0, 5}).force.z(), 3.3, 1e-9);
}

TEST(SafetyFilter, HoldsTheContinuousForceForAsLongAsOneLikes) {
  Loop loop({.max_force = 3.3, .heating_time = 0.1, .continuous_force = 2});
  const SafeCommand command = loop.after(20'000, {0, 0, 2});
  EXPECT_NEAR(command.force.z(), 2, 1e-9);
}

TEST(SafetyFilter, HasNoLimitOfHeatForDevicesThatDeclareNone) {
  Loop loop({.heating_time = 0.1});
  EXPECT_EQ(loop.after(20'000, {0, 0, 3.3}).actions, 0U);
}

TEST(SafetyFilter, ShortensTorques) {
  SafetyFilter filter({.ramp = 1e-6, .max_torque = 10});
  SafetyInput input{.torque = {0, 30, 0}};
  static_cast<void>(filter.filter(input));
  input.now = input.state_time = 1e-3;
  EXPECT_NEAR(filter.filter(input).torque.y(), 10, 1e-12);
}

TEST(SafetyFilter, RefusesLimitsWithoutSense) {
  EXPECT_NE(
      refusal([] { return SafetyFilter({.max_force = 0}); }).find("SafetyOptions::max_force is 0"),
      std::string::npos);
  EXPECT_NE(refusal([] { return SafetyFilter({.slew = kNaN}); }).find("SafetyOptions::slew"),
            std::string::npos);
  EXPECT_NE(
      refusal([] { return SafetyFilter({.heating_time = 0}); }).find("SafetyOptions::heating_time"),
      std::string::npos);
  EXPECT_NE(refusal([] { return SafetyFilter({.lease = 1}); }).find("SafetyOptions::lease"),
            std::string::npos);
}

TEST(SafetyFilter, SaysInWordsWhatItDid) {
  EXPECT_EQ(to_words(0), "");
  EXPECT_EQ(to_words(1 | 4), "ramped, slewed");
  EXPECT_EQ(to_words(8 | 512), "force not finite, heated");
}

}  // namespace
}  // namespace palpate::devices
