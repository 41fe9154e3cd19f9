// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/device_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::haptics {
namespace {

/// [mm] A tool that is nearer to its contact is not entered again into another model.
constexpr double kLeastDepth = 1e-6;

}  // namespace

DeviceLoop::DeviceLoop(const devices::DeviceDescription& device, const DeviceLoopOptions& options)
    : options_(options),
      rotation_(options.T_world_device.linear()),
      scale_(options.scale.value_or(device.workspace_scale)),
      clutch_buttons_(options.clutch_buttons | device.clutch_buttons),
      safety_(options.safety),
      model_(device.period) {
  require("DeviceLoopOptions::scale", scale_, above(0).finite(), "mm/mm");
  check_coupling(options.coupling);
  constexpr double kRotation = 1e-9;  // of the entries of R^T R
  if (!options.T_world_device.matrix().allFinite() ||
      !(rotation_.transpose() * rotation_).isIdentity(kRotation) || rotation_.determinant() < 0) {
    throw InvalidInput(
        "DeviceLoopOptions::T_world_device is no rigid motion; it must be a rotation and a "
        "translation in mm");
  }
  options_.safety.max_force = std::min(options.safety.max_force, device.highest_force);
  if (device.continuous_force > 0) {
    options_.safety.continuous_force =
        std::min(options.safety.continuous_force, device.continuous_force);
  }
  if (device.highest_torque > 0) {
    options_.safety.max_torque = std::min(options.safety.max_torque, device.highest_torque);
  }
  safety_ = devices::SafetyFilter(options_.safety);
  // The force is not scaled: k of the object is k scale at the device.
  spring_ =
      haptics::coupling_stiffness(options.coupling, device.damping, device.period, device.delay) /
      scale_;
}

double DeviceLoop::coupling_stiffness() const noexcept {
  return options_.coupling.on ? spring_ * scale_ : std::numeric_limits<double>::infinity();
}

// Brings a tool that touches the old model to the same place of another one, from outside.
void DeviceLoop::enter(const Playback& playback) noexcept {
  model_.exchange(playback);
  coupling_ = {};
  if (last_.state == ContactState::free) return;
  const Eigen::Vector3d outwards = last_.contact - last_.tool;
  if (!(outwards.norm() > kLeastDepth)) return;
  static_cast<void>(model_.try_tool(last_.contact + outwards));
  model_.end();
}

// The force on the user [N], in the world.
Eigen::Vector3d DeviceLoop::touch(ToolWorld& world, const Eigen::Vector3d& device,
                                  TickOutput& output) noexcept {
  const auto model = [&](const Eigen::Vector3d& tool) -> Eigen::Vector3d {
    trial_ = world.try_tool(tool);
    return trial_.force;
  };
  CoupledTool coupled{.tool = device};
  if (options_.coupling.on) {
    coupled = couple(options_.coupling, spring_, device, coupling_, model);
  } else {
    coupled.force = model(device);
  }
  output.tool = coupled.tool;
  output.contact = trial_.contact;
  output.state = trial_.state;
  return coupled.force;
}

TickOutput DeviceLoop::tick(const Playback& playback, const TickInput& input) noexcept {
  if (input.exchanged || model_.playback() != &playback) enter(playback);
  return tick(model_, input);
}

TickOutput DeviceLoop::tick(ToolWorld& world, const TickInput& input) noexcept {
  const devices::DeviceState& state = input.state;
  devices::SafetyInput safety{.now = input.now,
                              .state_time = state.time,
                              .answered = input.answered,
                              .finite = state.tip.allFinite() && std::isfinite(state.time),
                              .armed = state.armed,
                              .crossfade = input.exchanged};
  world.begin(input.now);
  TickOutput output = last_;
  Eigen::Vector3d wanted = Eigen::Vector3d::Zero();
  if (input.answered && safety.finite) {
    const Eigen::Vector3d place = options_.T_world_device * (scale_ * state.tip);
    const bool clutched = state.clutched || (state.buttons & clutch_buttons_) != 0;
    if (clutched) {
      if (has_place_) clutch_offset_ += place_ - place;  // the tool stands still
    } else {
      wanted = touch(world, place + clutch_offset_, output);
      safety.force = rotation_.transpose() * wanted;
      // Playback meets a position that cannot be, or has found the contact without a touch.
      safety.restart = trial_.held || trial_.started_inside;
    }
    safety.restart = safety.restart || clutched || clutched_;
    clutched_ = clutched;
    has_place_ = true;
    place_ = place;
  }
  world.end();
  output.command = safety_.filter(safety);
  if (safety.answered && safety.finite) {
    observer_.observe(state.tip, output.command.force);
  } else {
    observer_.release();
  }
  last_ = output;
  return output;
}

void DeviceLoop::check_age(double age, TickOutput& output) noexcept {
  safety_.check_age(age, output.command);
  if (output.command.force.isZero(0)) observer_.release();
}

}  // namespace palpate::haptics
