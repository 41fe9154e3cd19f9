// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "palpate/devices/safe_device.h"
#include "palpate/probing/virtual_arm.h"

// Faults between an arm and its program, and what a SafeDevice makes of them.
namespace palpate::devices::support {

/// A virtual arm in free space between which and the program something goes wrong.
class FaultyDevice final : public Device {
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
    future_states,
    not_finite
  };

  explicit FaultyDevice(unsigned seed) : arm_(nullptr, options(seed)) {}

  void begin(Fault fault) { fault_ = fault, age_ = 0; }

  const DeviceDescription& description() const noexcept override { return arm_.description(); }
  double now() const noexcept override { return arm_.now() + skipped_; }
  void activate() override { arm_.activate(); }
  bool read(DeviceState& state) noexcept override {
    DeviceState now_state;
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
    if (fault_ == Fault::future_states) now_state.time += 0.025;
    if (fault_ == Fault::not_finite) now_state.tip.z() = std::numeric_limits<double>::quiet_NaN();
    now_state.delivered_force += drift_;
    now_state.tip += offset_;
    state = last_ = now_state;
    return true;
  }
  bool write(const DeviceCommand& command) noexcept override {
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
  static probing::VirtualArmOptions options(unsigned seed) {
    probing::VirtualArmOptions options;
    options.gravity.setZero();
    options.seed = seed;
    return options;
  }

  probing::VirtualArm arm_;
  Fault fault_ = Fault::none;
  int age_ = 0;
  double skipped_ = 0;
  bool stopped_ = false;
  DeviceState last_;
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
  Eigen::Vector3d force(const DeviceState& state, double time) {
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

/// The faults, and the names they must get.
inline constexpr std::array<std::pair<FaultyDevice::Fault, DeviceFault>, 10> kInjectedFaults{
    {{FaultyDevice::Fault::disconnected, DeviceFault::no_answer},
     {FaultyDevice::Fault::frozen_encoders, DeviceFault::frozen},
     {FaultyDevice::Fault::jump, DeviceFault::jump},
     {FaultyDevice::Fault::saturated, DeviceFault::force_not_delivered},
     {FaultyDevice::Fault::tripped, DeviceFault::force_not_delivered},
     {FaultyDevice::Fault::late, DeviceFault::late},
     {FaultyDevice::Fault::zero_force, DeviceFault::force_exactly_zero},
     {FaultyDevice::Fault::drift, DeviceFault::force_not_delivered},
     {FaultyDevice::Fault::old_states, DeviceFault::state_too_old},
     {FaultyDevice::Fault::not_finite, DeviceFault::state_not_finite}}};

struct FaultOutcome {
  DeviceFault before = DeviceFault::none;  ///< must be none: the arm was healthy
  DeviceFault found = DeviceFault::none;
  int ticks = 0;         ///< from the fault to zero force
  bool is_safe = false;  ///< no force arrives at the motors, and they are off
  bool stays = false;    ///< until the arm is activated again
  bool resumed = false;  ///< once it is repaired
};

/// Lets a fault begin while the tip swings, after 0.4 to 0.6 s.
inline FaultOutcome outcome_of_fault(FaultyDevice::Fault fault, unsigned seed) {
  using Fault = FaultyDevice::Fault;
  FaultyDevice device(seed);
  SafeDevice arm(device);
  arm.activate();
  Swing swing(seed);
  DeviceState state;
  FaultOutcome outcome;
  const int before = 400 + static_cast<int>(seed * 37 % 200);
  int tick = 0, healthy = 0;
  const auto step = [&] {
    const bool good = arm.read(state);
    return arm.write({.force = swing.force(state, 1e-3 * ++tick)}) && good;
  };
  while (healthy < before && step()) ++healthy;
  // The tip moves fast when the encoders freeze: at rest nobody can tell, and nothing happens.
  if (fault == Fault::frozen_encoders) {
    for (Eigen::Vector3d last = state.tip; healthy < before + 2000; last = state.tip) {
      if (!step()) break;
      ++healthy;
      if ((state.tip - last).norm() > 0.16) break;
    }
  }
  outcome.before = arm.fault();
  device.begin(fault);
  const SafetyLimits limits;
  double wrong_force = 0;  // [N] missing at the tick before
  Eigen::Vector3d last_force = device.force();
  while (outcome.ticks < 1000) {
    ++outcome.ticks;
    const bool good = step();
    // A wrong force is a fault from the tick on at which it leaves the tolerance.
    const double tolerated = limits.force_tolerance + limits.force_relative * device.force().norm();
    if (fault == Fault::drift && device.drift() < tolerated) outcome.ticks = 0;
    if ((fault == Fault::saturated || fault == Fault::tripped) && wrong_force < 0.21) {
      outcome.ticks = 0;
    }
    wrong_force = 0.7 * std::min(last_force.norm(), device.force().norm());
    last_force = device.force();
    if (!good) break;
  }
  outcome.found = arm.fault();
  // A device that is not there gets no command; its lease ends.
  outcome.is_safe = device.stopped() && (fault == Fault::disconnected || device.force().isZero(0));
  outcome.stays = true;
  for (int i = 0; i < 5; ++i) outcome.stays = !step() && outcome.stays;
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

}  // namespace palpate::devices::support
