// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/devices/safe_device.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

#include "faulty_device.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "palpate/probing/arm_kinematics.h"
#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::devices {
namespace {

using support::FaultyDevice;

// A hundred seeds are in studies/probing_validation.
constexpr unsigned kSeeds = 20;

TEST(SafeDevice, IsSafeWithinTwoTicksOfAnyFaultNamesItAndResumes) {
  for (const auto& [fault, name] : support::kInjectedFaults) {
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      const support::FaultOutcome outcome = support::outcome_of_fault(fault, seed);
      EXPECT_EQ(to_string(outcome.before), "none") << to_string(name) << " " << seed;
      EXPECT_EQ(to_string(outcome.found), to_string(name)) << seed;
      // A drift of 10 N/s hides two ticks more in a command that changes, as motors may lag by one.
      const int most = fault == FaultyDevice::Fault::drift ? 4 : 2;
      EXPECT_LE(outcome.ticks, most) << to_string(name) << " " << seed;
      EXPECT_TRUE(outcome.is_safe) << to_string(name) << " " << seed;
      EXPECT_TRUE(outcome.stays) << to_string(name) << " " << seed;
      EXPECT_TRUE(outcome.resumed) << to_string(name) << " " << seed;
      if (HasFailure()) return;
    }
  }
}

/// A safe arm at rest in free space.
struct Rig {
  explicit Rig(const SafetyLimits& limits = {}, const EmergencyStop* stop = nullptr)
      : device(1), arm(device, limits, stop) {
    arm.activate();
    step(Eigen::Vector3d::Zero());
    begin = state.tip;
  }
  bool step(const Eigen::Vector3d& force) { return arm.read(state) && arm.write({.force = force}); }

  FaultyDevice device;
  SafeDevice arm;
  DeviceState state;
  Eigen::Vector3d begin;
};

TEST(SafeDevice, StopsAtAStateOfTheFuture) {
  Rig rig;
  EXPECT_EQ(rig.arm.fault(), DeviceFault::none);
  rig.device.begin(FaultyDevice::Fault::future_states);
  EXPECT_FALSE(rig.step(Eigen::Vector3d::Zero()));
  EXPECT_EQ(to_string(rig.arm.fault()), "state too old");
}

TEST(SafeDevice, LimitsForceAndSlew) {
  SafetyLimits limits;
  limits.max_force = 0.5;
  limits.slew = 40;
  Rig rig(limits);
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  double longest = 0;
  for (int i = 0; i < 60; ++i) {
    ASSERT_TRUE(rig.step({i % 30 < 20 ? 7.0 : -7.0, 0, 5}));
    const Eigen::Vector3d force = rig.device.force();
    EXPECT_LE(force.norm(), 0.5 + 1e-12);
    EXPECT_LE((force - last).norm(), 0.04 + 1e-12);
    longest = std::max(longest, force.norm());
    last = force;
  }
  EXPECT_NEAR(longest, 0.5, 1e-9);
}

TEST(SafeDevice, TakesAwayForceOutOfTheWorkspaceAndStopsBeyondItsMargin) {
  SafetyLimits limits;
  FaultyDevice probe(1);
  const Eigen::Vector3d place = probing::tip_position({}, Eigen::Vector3d::Zero());
  limits.workspace = {place - Eigen::Vector3d::Constant(2), place + Eigen::Vector3d::Constant(2)};
  Rig rig(limits);
  bool taken = false;
  DeviceFault fault = DeviceFault::none;
  for (int i = 0; i < 300 && fault == DeviceFault::none; ++i) {
    rig.step({0, 0.3, 0});
    fault = rig.arm.fault();
    if (fault == DeviceFault::none && rig.state.tip.y() > place.y() + 3) {
      taken = taken || rig.device.force().y() <= 0;
    }
  }
  EXPECT_TRUE(taken);
  EXPECT_LT(rig.state.tip.y(), place.y() + 7.5);
}

TEST(SafeDevice, StopsATipThatIsTooDeepOrTooFast) {
  SafetyLimits limits;
  limits.depth = 1;
  limits.margin = 0.5;
  Rig deep(limits);
  deep.arm.limit_depth(deep.begin, -Eigen::Vector3d::UnitY());
  for (int i = 0; i < 300 && deep.arm.fault() == DeviceFault::none; ++i) deep.step({0, -0.8, 0});
  EXPECT_EQ(to_string(deep.arm.fault()), "too deep");
  EXPECT_GT(deep.state.tip.y(), deep.begin.y() - 2.2);

  limits = {};
  limits.speed = 50;
  limits.speed_margin = 1;
  Rig fast(limits);
  for (int i = 0; i < 300 && fast.arm.fault() == DeviceFault::none; ++i) fast.step({0, -2, 0});
  EXPECT_EQ(to_string(fast.arm.fault()), "too fast");
}

TEST(SafeDevice, StopsAtACommandThatIsNotFinite) {
  Rig rig;
  ASSERT_TRUE(rig.step({0.1, 0, 0}));
  EXPECT_FALSE(rig.step({0, kNaN, 0}));
  EXPECT_EQ(rig.arm.fault(), DeviceFault::command_not_finite);
  EXPECT_TRUE(rig.device.force().isZero(0));
  EXPECT_NEAR(rig.arm.fault_time(), rig.device.now(), 1e-9);
}

TEST(SafeDevice, LetsHotMotorsRestUntilTheyAreCool) {
  SafetyLimits limits;
  limits.slew = 1e4;
  limits.speed = 2000;
  limits.highest_acceleration = 5e5;
  Rig rig(limits);
  double seconds = 0;
  // Turning the force to and fro heats the motors, but moves the tip little.
  while (rig.arm.fault() == DeviceFault::none && seconds < 15) {
    rig.step({0, (static_cast<int>(seconds * 200) % 2 == 0) ? 3.0 : -3.0, 0});
    seconds += 1e-3;
  }
  EXPECT_EQ(to_string(rig.arm.fault()), "motor too hot");
  EXPECT_THROW(rig.arm.activate(), DeviceError);
  while (rig.state.heat.maxCoeff() >= 0.5) static_cast<void>(rig.arm.read(rig.state));
  rig.arm.activate();
  EXPECT_TRUE(rig.step({0.1, 0, 0}));
}

TEST(SafeDevice, StopsWhenTheEmergencyStopIsPressedByTheProgramAFileOrASignal) {
  const ScratchFolder folder;
  const auto file = folder / "stop";
  EmergencyStop stop(file);
  stop.press_on_signals();
  const std::vector<std::function<void()>> presses = {
      [&] { stop.press(); }, [&] { std::ofstream(file) << "stop"; }, [] { std::raise(SIGTERM); }};
  for (const auto& press : presses) {
    Rig rig({}, &stop);
    ASSERT_TRUE(rig.step({0.1, 0, 0}));
    press();
    for (int i = 0; i < 1000 && !stop.pressed(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    EXPECT_FALSE(rig.step({0.1, 0, 0}));
    EXPECT_EQ(to_string(rig.arm.fault()), "emergency stop");
    EXPECT_TRUE(rig.device.force().isZero(0));
    EXPECT_THROW(rig.arm.activate(), DeviceError);
    std::filesystem::remove(file);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    stop.release();
    rig.arm.activate();
    EXPECT_TRUE(rig.step({0.1, 0, 0}));
  }
}

TEST(SafeDevice, ChecksItsLimitsByName) {
  FaultyDevice device(1);
  SafetyLimits limits;
  limits.max_force = 0;
  EXPECT_EQ(refusal([&] { return SafeDevice(device, limits).fault(); }),
            "SafetyLimits::max_force is 0 N; it must be > 0 and finite");
  limits = {};
  limits.workspace.setEmpty();
  EXPECT_EQ(refusal([&] { return SafeDevice(device, limits).fault(); }),
            "SafetyLimits::workspace is empty; its low corner must be below its high");
}

}  // namespace
}  // namespace palpate::devices
