// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/devices/safe_device.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <string>
#include <system_error>

#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::devices {
namespace {

std::atomic<EmergencyStop*> stop_of_signals{nullptr};
static_assert(std::atomic<EmergencyStop*>::is_always_lock_free, "used in a signal handler");

extern "C" void press_stop_of_signals(int) {
  if (EmergencyStop* stop = stop_of_signals.load()) stop->press();
}

}  // namespace

std::string_view to_string(DeviceFault fault) noexcept {
  switch (fault) {
    case DeviceFault::none:
      return "none";
    case DeviceFault::no_answer:
      return "arm does not answer";
    case DeviceFault::state_not_finite:
      return "state not finite";
    case DeviceFault::state_too_old:
      return "state too old";
    case DeviceFault::late:
      return "loop late";
    case DeviceFault::frozen:
      return "encoders frozen";
    case DeviceFault::jump:
      return "position jumps";
    case DeviceFault::too_fast:
      return "too fast";
    case DeviceFault::outside_workspace:
      return "outside the workspace";
    case DeviceFault::too_deep:
      return "too deep";
    case DeviceFault::force_not_delivered:
      return "force not delivered";
    case DeviceFault::force_exactly_zero:
      return "measured force exactly zero";
    case DeviceFault::too_hot:
      return "motor too hot";
    case DeviceFault::command_not_finite:
      return "command not finite";
    case DeviceFault::emergency_stop:
      return "emergency stop";
  }
  return "unknown";
}

EmergencyStop::EmergencyStop(const std::optional<std::filesystem::path>& file) {
  if (!file) return;
  watcher_ = std::thread([this, path = *file] {
    constexpr std::chrono::milliseconds kInterval(3);
    while (!done_.load(std::memory_order_relaxed)) {
      std::error_code ignored;
      if (std::filesystem::exists(path, ignored)) press();
      std::this_thread::sleep_for(kInterval);
    }
  });
}

EmergencyStop::~EmergencyStop() {
  done_.store(true, std::memory_order_relaxed);
  if (watcher_.joinable()) watcher_.join();
  if (handles_signals_) {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    stop_of_signals.store(nullptr);
  }
}

void EmergencyStop::press_on_signals() {
  EmergencyStop* nobody = nullptr;
  if (!stop_of_signals.compare_exchange_strong(nobody, this) && nobody != this) {
    throw InvalidInput("EmergencyStop::press_on_signals: another stop already handles signals");
  }
  handles_signals_ = true;
  std::signal(SIGINT, press_stop_of_signals);
  std::signal(SIGTERM, press_stop_of_signals);
}

SafeDevice::SafeDevice(Device& device, const SafetyLimits& limits,
                       const EmergencyStop* emergency_stop)
    : device_(device), limits_(limits), emergency_stop_(emergency_stop) {
  require("SafetyLimits::max_force", limits.max_force, above(0).finite(), "N");
  require("SafetyLimits::slew", limits.slew, above(0).finite(), "N/s");
  require("SafetyLimits::speed", limits.speed, above(0).finite(), "mm/s");
  require("SafetyLimits::speed_margin", limits.speed_margin, above(0).finite(), "mm/s");
  require("SafetyLimits::margin", limits.margin, above(0).finite(), "mm");
  require("SafetyLimits::depth", limits.depth, above(0).finite(), "mm");
  require("SafetyLimits::oldest_state", limits.oldest_state, above(0).finite(), "s");
  require("SafetyLimits::lease", limits.lease, above(0).at_most(0.1), "s");
  require("SafetyLimits::highest_acceleration", limits.highest_acceleration, above(0).finite(),
          "mm/s^2");
  require("SafetyLimits::quantum", limits.quantum, above(0).finite(), "mm");
  require("SafetyLimits::longest_standstill", limits.longest_standstill, above(0).finite(), "s");
  require("SafetyLimits::standstill_force", limits.standstill_force, above(0).finite(), "N");
  require("SafetyLimits::force_tolerance", limits.force_tolerance, above(0).finite(), "N");
  require("SafetyLimits::force_relative", limits.force_relative, at_least(0).below(1));
  require("SafetyLimits::hottest", limits.hottest, above(0).below(1));
  require("SafetyLimits::cool", limits.cool, above(0).below(limits.hottest));
  if (limits.workspace.isEmpty()) {
    throw InvalidInput("SafetyLimits::workspace is empty; its low corner must be below its high");
  }
}

SafeDevice::~SafeDevice() { stop(); }

const DeviceDescription& SafeDevice::description() const noexcept { return device_.description(); }

double SafeDevice::now() const noexcept { return device_.now(); }

void SafeDevice::forget() noexcept {
  any_state_ = false;
  velocity_.setZero();
  force_.setZero();
  earlier_force_.setZero();
  wrong_force_ = zero_force_ = still_ = 0;
  last_loop_ = device_.now();
}

void SafeDevice::activate() {
  if (emergency_stop_ != nullptr && emergency_stop_->pressed()) {
    throw DeviceError(description().name + ": the emergency stop is pressed; release it first");
  }
  if (hot_) {
    throw DeviceError(description().name + ": a motor is hot; wait until its heat is below " +
                      std::to_string(limits_.cool));
  }
  forget();
  device_.activate();
  fault_ = DeviceFault::none;
}

void SafeDevice::raise(DeviceFault fault) noexcept {
  if (fault_ != DeviceFault::none) return;
  fault_ = fault;
  fault_time_ = device_.now();
  force_.setZero();
  static_cast<void>(device_.write({.force = Eigen::Vector3d::Zero(), .lease = limits_.lease}));
  device_.stop();
}

void SafeDevice::stop() noexcept {
  force_.setZero();
  static_cast<void>(device_.write({.force = Eigen::Vector3d::Zero(), .lease = limits_.lease}));
  device_.stop();
}

void SafeDevice::limit_depth(const Eigen::Vector3d& place,
                             const Eigen::Vector3d& inwards) noexcept {
  plane_ = Eigen::Hyperplane<double, 3>(inwards, place);
}

bool SafeDevice::read(DeviceState& state) noexcept {
  DeviceState measured;
  if (!device_.read(measured)) {
    raise(DeviceFault::no_answer);
    return false;
  }
  if (const DeviceFault fault = check_state(measured); fault != DeviceFault::none) raise(fault);
  state = measured;
  return fault_ == DeviceFault::none;
}

DeviceFault SafeDevice::check_state(const DeviceState& state) noexcept {
  if (!state.tip.allFinite() || !std::isfinite(state.time)) return DeviceFault::state_not_finite;
  const double now = device_.now();
  const double loop = now - last_loop_;
  last_loop_ = now;
  if (loop > limits_.lease) return DeviceFault::late;
  if (std::abs(now - state.time) > limits_.oldest_state) return DeviceFault::state_too_old;
  if (emergency_stop_ != nullptr && emergency_stop_->pressed()) return DeviceFault::emergency_stop;
  if (state.heat.allFinite()) {
    const double hottest = state.heat.maxCoeff();
    if (hottest > limits_.hottest) hot_ = true;
    if (hottest < limits_.cool) hot_ = false;
    if (hottest > limits_.hottest) return DeviceFault::too_hot;
  } else if (description().measures_heat) {
    return DeviceFault::state_not_finite;
  }
  if (const DeviceFault fault = check_motion(state); fault != DeviceFault::none) return fault;
  if (const DeviceFault fault = check_force(state); fault != DeviceFault::none) return fault;
  if (velocity_.norm() > limits_.speed + limits_.speed_margin) return DeviceFault::too_fast;
  if (limits_.workspace.exteriorDistance(state.tip) > limits_.margin) {
    return DeviceFault::outside_workspace;
  }
  if (plane_ && plane_->signedDistance(state.tip) > limits_.depth + limits_.margin) {
    return DeviceFault::too_deep;
  }
  return DeviceFault::none;
}

DeviceFault SafeDevice::check_motion(const DeviceState& state) noexcept {
  constexpr double kSmoothing = 0.2;  // weight of the latest difference in the velocity
  if (!any_state_) {
    any_state_ = true;
    last_ = state;
    still_since_ = state.time;
    still_force_ = force_;
    return DeviceFault::none;
  }
  const double period = state.time - last_.time;
  if (period <= 0) {  // the same state again
    return ++still_ > 1 ? DeviceFault::frozen : DeviceFault::none;
  }
  const Eigen::Vector3d step = state.tip - last_.tip;
  if (step.isZero(0)) {
    // One state without motion may be quantisation. With two, the tip has stopped from its last
    // speed, and its highest acceleration limits how fast it can have braked.
    if (++still_ == 1) return DeviceFault::none;
    const double braking = period * period * limits_.highest_acceleration / 2;
    const bool stopped_dead =
        still_ == 2 && period * velocity_.norm() > 2 * limits_.quantum + braking;
    const bool stands = state.time - still_since_ > limits_.longest_standstill &&
                        (force_ - still_force_).norm() > limits_.standstill_force;
    if (stopped_dead || stands) return DeviceFault::frozen;
  } else {
    // The smoothed speed lags behind by 1 / kSmoothing - 1 states, and the speed changes further on
    // the way, which is longer than a state's if one without motion came before.
    const double tick = description().period;
    const double changing = (1 / kSmoothing - 1) * tick + (period + tick) / 2;
    const double reach = 2 * limits_.quantum + limits_.highest_acceleration * period * changing;
    if ((step - period * velocity_).norm() > reach) return DeviceFault::jump;
    still_ = 0;
    still_since_ = state.time;
    still_force_ = force_;
  }
  velocity_ += kSmoothing * (step / period - velocity_);
  last_ = state;
  return DeviceFault::none;
}

DeviceFault SafeDevice::check_force(const DeviceState& state) noexcept {
  constexpr int kStates = 2;  // in succession
  if (!description().measures_force) return DeviceFault::none;
  if (!state.delivered_force.allFinite()) return DeviceFault::state_not_finite;
  zero_force_ = state.delivered_force.isZero(0) ? zero_force_ + 1 : 0;
  if (zero_force_ >= kStates) return DeviceFault::force_exactly_zero;
  // The motors may lag by one command.
  const double error = std::min((state.delivered_force - force_).norm(),
                                (state.delivered_force - earlier_force_).norm());
  const double tolerance = limits_.force_tolerance + limits_.force_relative * force_.norm();
  wrong_force_ = error > tolerance ? wrong_force_ + 1 : 0;
  return wrong_force_ >= kStates ? DeviceFault::force_not_delivered : DeviceFault::none;
}

Eigen::Vector3d SafeDevice::limited(const Eigen::Vector3d& wanted) const noexcept {
  Eigen::Vector3d force = wanted;
  const double speed = velocity_.norm();
  if (speed > limits_.speed) {
    const Eigen::Vector3d ahead = velocity_ / speed;
    force -= std::max(force.dot(ahead), 0.0) * ahead;
  }
  for (int i = 0; i < 3; ++i) {
    if (last_.tip[i] > limits_.workspace.max()[i]) force[i] = std::min(force[i], 0.0);
    if (last_.tip[i] < limits_.workspace.min()[i]) force[i] = std::max(force[i], 0.0);
  }
  if (plane_ && plane_->signedDistance(last_.tip) > limits_.depth) {
    force -= std::max(force.dot(plane_->normal()), 0.0) * plane_->normal();
  }
  const Eigen::Vector3d change = force - force_;
  const double longest = limits_.slew * description().period;
  if (change.norm() > longest) force = force_ + change * (longest / change.norm());
  if (force.norm() > limits_.max_force) force *= limits_.max_force / force.norm();
  return force;
}

bool SafeDevice::write(const DeviceCommand& command) noexcept {
  if (!command.force.allFinite() || !std::isfinite(command.lease)) {
    raise(DeviceFault::command_not_finite);
  } else if (device_.now() - last_loop_ > limits_.lease) {
    raise(DeviceFault::late);
  } else if (emergency_stop_ != nullptr && emergency_stop_->pressed()) {
    raise(DeviceFault::emergency_stop);
  }
  if (fault_ != DeviceFault::none) return false;
  earlier_force_ = force_;
  force_ = limited(command.force);
  const double lease = std::clamp(command.lease, 0.0, limits_.lease);
  if (device_.write({.force = force_, .lease = lease})) return true;
  raise(DeviceFault::no_answer);
  return false;
}

}  // namespace palpate::devices
