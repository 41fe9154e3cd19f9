// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/safe_arm.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <functional>
#include <random>
#include <string>
#include <thread>

#include "not_finite.h"
#include "palpate/error.h"
#include "palpate/probing/virtual_arm.h"
#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::probing {
namespace {

/// A virtual arm in free space between which and the program something goes wrong.
class FaultyArm final : public Arm {
 public:
  enum class Fault {
    none,
    disconnected,
    frozen_encoders,
    jump,
    saturated,
    tripped,
    late,
    zero_force,
    drift,
    old_states,
    not_finite
  };

  explicit FaultyArm(unsigned seed) : arm_(nullptr, options(seed)) {}

  void begin(Fault fault) { fault_ = fault, age_ = 0; }

  const ArmDescription& description() const noexcept override { return arm_.description(); }
  double now() const noexcept override { return arm_.now() + skipped_; }
  void activate() override { arm_.activate(); }
  bool read(ArmState& state) noexcept override {
    ArmState now_state;
    if (!arm_.read(now_state)) return false;
    now_state.time += skipped_;
    ++age_;
    if (fault_ == Fault::disconnected) return false;
    if (fault_ == Fault::frozen_encoders) now_state.tip = last_.tip;
    if (fault_ == Fault::jump && age_ == 1) offset_ = Eigen::Vector3d(0.4, -1.1, 0.7);
    if (fault_ == Fault::saturated) now_state.delivered_force *= 0.3;
    if (fault_ == Fault::tripped) now_state.delivered_force *= 1e-3;
    if (fault_ == Fault::late && age_ == 1) {
      skipped_ += 0.03;
      now_state.time += 0.03;
    }
    if (fault_ == Fault::zero_force) now_state.delivered_force.setZero();
    if (fault_ == Fault::drift) drift_.x() += 0.01;
    if (fault_ == Fault::old_states) now_state.time -= 0.025;
    if (fault_ == Fault::not_finite) now_state.tip.z() = kNaN;
    now_state.delivered_force += drift_;
    now_state.tip += offset_;
    state = last_ = now_state;
    return true;
  }
  bool write(const ArmCommand& command) noexcept override {
    if (fault_ == Fault::disconnected) return false;
    force_ = command.force;
    return arm_.write(command);
  }
  void stop() noexcept override {
    stopped_ = true;
    arm_.stop();
  }

  void repair() {
    fault_ = Fault::none;
    drift_.setZero();
    stopped_ = false;
  }
  Eigen::Vector3d force() const { return force_; }  // that arrived last
  bool stopped() const { return stopped_; }
  double drift() const { return drift_.x(); }

 private:
  static VirtualArmOptions options(unsigned seed) {
    VirtualArmOptions options;
    options.gravity.setZero();
    options.seed = seed;
    return options;
  }

  VirtualArm arm_;
  Fault fault_ = Fault::none;
  int age_ = 0;
  double skipped_ = 0;
  bool stopped_ = false;
  ArmState last_;
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero(), drift_ = Eigen::Vector3d::Zero();
};

/// A program that swings the tip to and fro at up to about 200 mm/s, with gravity compensated.
class Swing {
 public:
  explicit Swing(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> phase(0, 6);
    phase_ = phase(random);
  }
  Eigen::Vector3d force(const ArmState& state, double time) {
    if (!begun_) centre_ = state.tip;
    begun_ = true;
    const Eigen::Vector3d wanted = centre_ + 9 * std::sin(24 * time + phase_) *
                                                 Eigen::Vector3d(0.6, 0.8, 0) *
                                                 std::min(1.0, time / 0.3);
    return 0.2 * (wanted - state.tip);
  }
  void restart() { begun_ = false; }

 private:
  double phase_ = 0;
  bool begun_ = false;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
};

using Fault = FaultyArm::Fault;

struct Outcome {
  int healthy_ticks = 0;  // before the fault, without an alarm
  int ticks = 0;          // from the fault to zero force
  ArmFault found = ArmFault::none;
  bool resumed = false;
};

Outcome outcome_of(Fault fault, unsigned seed) {
  FaultyArm device(seed);
  SafeArm arm(device);
  arm.activate();
  Swing swing(seed);
  ArmState state;
  Outcome outcome;
  const int before = 400 + static_cast<int>(seed * 37 % 200);
  int tick = 0;
  const auto step = [&] {
    const bool good = arm.read(state);
    return arm.write({.force = swing.force(state, 1e-3 * ++tick)}) && good;
  };
  while (outcome.healthy_ticks < before && step()) ++outcome.healthy_ticks;
  // The tip moves fast when the encoders freeze: at rest nobody can tell, and nothing happens.
  if (fault == Fault::frozen_encoders) {
    for (Eigen::Vector3d last = state.tip; outcome.healthy_ticks < before + 2000;
         last = state.tip) {
      if (!step()) break;
      ++outcome.healthy_ticks;
      if ((state.tip - last).norm() > 0.16) break;
    }
  }
  EXPECT_EQ(to_string(arm.fault()), "none") << "before the fault, seed " << seed;
  device.begin(fault);
  double wrong_force = 0;  // [N] missing at the tick before
  Eigen::Vector3d last_force = device.force();
  while (outcome.ticks < 1000) {
    ++outcome.ticks;
    const bool good = step();
    // A wrong force is a fault from the tick on at which it leaves the tolerance.
    if (fault == Fault::drift && device.drift() < 0.19) outcome.ticks = 0;
    if ((fault == Fault::saturated || fault == Fault::tripped) && wrong_force < 0.21) {
      outcome.ticks = 0;
    }
    wrong_force = 0.7 * std::min(last_force.norm(), device.force().norm());
    last_force = device.force();
    if (!good) break;
  }
  outcome.found = arm.fault();
  if (fault != Fault::disconnected) {
    EXPECT_EQ(device.force().norm(), 0);
  }
  EXPECT_TRUE(device.stopped());
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(step());  // the fault stays
  device.repair();
  // The motors are off until the tip has come to rest.
  for (int i = 0; i < 300; ++i) static_cast<void>(arm.read(state));
  arm.activate();
  swing.restart();
  tick = 0;
  outcome.resumed = true;
  for (int i = 0; i < 100; ++i) outcome.resumed = step() && outcome.resumed;
  return outcome;
}

constexpr unsigned kSeeds = 20;

TEST(SafeArm, IsSafeWithinTwoTicksOfAnyFaultNamesItAndResumes) {
  const std::vector<std::pair<Fault, ArmFault>> faults = {
      {Fault::disconnected, ArmFault::no_answer},
      {Fault::frozen_encoders, ArmFault::frozen},
      {Fault::jump, ArmFault::jump},
      {Fault::saturated, ArmFault::force_not_delivered},
      {Fault::tripped, ArmFault::force_not_delivered},
      {Fault::late, ArmFault::late},
      {Fault::zero_force, ArmFault::force_exactly_zero},
      {Fault::drift, ArmFault::force_not_delivered},
      {Fault::old_states, ArmFault::state_too_old},
      {Fault::not_finite, ArmFault::state_not_finite}};
  for (const auto& [fault, name] : faults) {
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      const Outcome outcome = outcome_of(fault, seed);
      EXPECT_EQ(to_string(outcome.found), to_string(name)) << seed;
      EXPECT_LE(outcome.ticks, 2) << to_string(name) << " " << seed;
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

  FaultyArm device;
  SafeArm arm;
  ArmState state;
  Eigen::Vector3d begin;
};

TEST(SafeArm, LimitsForceAndSlew) {
  SafetyLimits limits;
  limits.force = 0.5;
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

TEST(SafeArm, TakesAwayForceOutOfTheWorkspaceAndStopsBeyondItsMargin) {
  SafetyLimits limits;
  FaultyArm probe(1);
  const Eigen::Vector3d place = tip_position({}, Eigen::Vector3d::Zero());
  limits.workspace = {place - Eigen::Vector3d::Constant(2), place + Eigen::Vector3d::Constant(2)};
  Rig rig(limits);
  bool taken = false;
  ArmFault fault = ArmFault::none;
  for (int i = 0; i < 300 && fault == ArmFault::none; ++i) {
    rig.step({0, 0.3, 0});
    fault = rig.arm.fault();
    if (fault == ArmFault::none && rig.state.tip.y() > place.y() + 3) {
      taken = taken || rig.device.force().y() <= 0;
    }
  }
  EXPECT_TRUE(taken);
  EXPECT_LT(rig.state.tip.y(), place.y() + 7.5);
}

TEST(SafeArm, StopsATipThatIsTooDeepOrTooFast) {
  SafetyLimits limits;
  limits.depth = 1;
  limits.margin = 0.5;
  Rig deep(limits);
  deep.arm.limit_depth(deep.begin, -Eigen::Vector3d::UnitY());
  for (int i = 0; i < 300 && deep.arm.fault() == ArmFault::none; ++i) deep.step({0, -0.8, 0});
  EXPECT_EQ(to_string(deep.arm.fault()), "too deep");
  EXPECT_GT(deep.state.tip.y(), deep.begin.y() - 2.2);

  limits = {};
  limits.speed = 50;
  limits.speed_margin = 1;
  Rig fast(limits);
  for (int i = 0; i < 300 && fast.arm.fault() == ArmFault::none; ++i) fast.step({0, -2, 0});
  EXPECT_EQ(to_string(fast.arm.fault()), "too fast");
}

TEST(SafeArm, StopsAtACommandThatIsNotFinite) {
  Rig rig;
  ASSERT_TRUE(rig.step({0.1, 0, 0}));
  EXPECT_FALSE(rig.step({0, kNaN, 0}));
  EXPECT_EQ(rig.arm.fault(), ArmFault::command_not_finite);
  EXPECT_TRUE(rig.device.force().isZero(0));
  EXPECT_NEAR(rig.arm.fault_time(), rig.device.now(), 1e-9);
}

TEST(SafeArm, LetsHotMotorsRestUntilTheyAreCool) {
  SafetyLimits limits;
  limits.slew = 1e4;
  limits.speed = 2000;
  limits.highest_acceleration = 5e5;
  Rig rig(limits);
  double seconds = 0;
  // Turning the force to and fro heats the motors, but moves the tip little.
  while (rig.arm.fault() == ArmFault::none && seconds < 15) {
    rig.step({0, (static_cast<int>(seconds * 200) % 2 == 0) ? 3.0 : -3.0, 0});
    seconds += 1e-3;
  }
  EXPECT_EQ(to_string(rig.arm.fault()), "motor too hot");
  EXPECT_THROW(rig.arm.activate(), DeviceError);
  while (rig.state.heat.maxCoeff() >= 0.5) static_cast<void>(rig.arm.read(rig.state));
  rig.arm.activate();
  EXPECT_TRUE(rig.step({0.1, 0, 0}));
}

TEST(SafeArm, StopsWhenTheEmergencyStopIsPressedByTheProgramAFileOrASignal) {
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

TEST(SafeArm, ChecksItsLimitsByName) {
  FaultyArm device(1);
  SafetyLimits limits;
  limits.force = 0;
  EXPECT_EQ(refusal([&] { return SafeArm(device, limits).fault(); }),
            "SafetyLimits::force is 0 N; it must be > 0 and finite");
  limits = {};
  limits.workspace.setEmpty();
  EXPECT_EQ(refusal([&] { return SafeArm(device, limits).fault(); }),
            "SafetyLimits::workspace is empty; its low corner must be below its high");
}

}  // namespace
}  // namespace palpate::probing
