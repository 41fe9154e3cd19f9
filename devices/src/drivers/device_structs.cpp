// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/device_structs.h"

#include <algorithm>
#include <iterator>

namespace palpate::devices {
namespace {

struct Capability {
  unsigned bit;
  bool DeviceDescription::*member;
};
// The capabilities that a description has as they are.
constexpr Capability kCapabilities[] = {
    {PALPATE_DEVICE_MEASURES_FORCE, &DeviceDescription::measures_force},
    {PALPATE_DEVICE_MEASURES_HEAT, &DeviceDescription::measures_heat},
    {PALPATE_DEVICE_MEASURES_REFERENCE, &DeviceDescription::measures_reference},
    {PALPATE_DEVICE_MEASURES_VELOCITY, &DeviceDescription::measures_velocity},
    {PALPATE_DEVICE_MEASURES_ORIENTATION, &DeviceDescription::measures_orientation},
    {PALPATE_DEVICE_REPORTS_ARMED, &DeviceDescription::reports_armed}};

template <typename Vector, std::size_t size>
void put(const Vector& from, double (&to)[size]) noexcept {
  std::copy_n(from.data(), std::min<std::size_t>(size, static_cast<std::size_t>(from.size())), to);
}

}  // namespace

DeviceDescription description_of(const palpate_device_info_v1& info, bool real_time) {
  const auto can = [&](unsigned bit) { return (info.capabilities & bit) != 0; };
  const auto* end = std::find(std::begin(info.name), std::end(info.name), '\0');
  DeviceDescription description{
      .name = std::string(std::begin(info.name), end),
      .period = info.period,
      .highest_force = info.highest_force,
      .continuous_force = info.continuous_force,
      .measures_joints = can(PALPATE_DEVICE_MEASURES_JOINTS) && info.joints >= 3,
      .real_time = real_time,
      .highest_torque = can(PALPATE_DEVICE_APPLIES_TORQUE) ? info.highest_torque : 0,
      .damping = info.damping,
      .friction = info.friction,
      .resolution = info.resolution,
      .delay = info.delay,
      .workspace_scale = info.workspace_scale > 0 ? info.workspace_scale : 1,
      .clutch_buttons = info.clutch_buttons};
  for (const Capability& capability : kCapabilities) {
    description.*capability.member = can(capability.bit);
  }
  return description;
}

palpate_device_info_v1 struct_of(const DeviceDescription& description) noexcept {
  palpate_device_info_v1 info{};
  info.size = sizeof(info);
  for (const Capability& capability : kCapabilities) {
    if (description.*capability.member) info.capabilities |= capability.bit;
  }
  if (description.measures_joints) info.capabilities |= PALPATE_DEVICE_MEASURES_JOINTS;
  if (description.highest_torque > 0) info.capabilities |= PALPATE_DEVICE_APPLIES_TORQUE;
  info.joints = description.measures_joints ? 3 : 0;
  description.name.copy(std::begin(info.name), sizeof(info.name) - 1);
  info.period = description.period;
  info.highest_force = description.highest_force;
  info.continuous_force = description.continuous_force;
  info.highest_torque = description.highest_torque;
  info.damping = description.damping;
  info.friction = description.friction;
  info.resolution = description.resolution;
  info.delay = description.delay;
  info.workspace_scale = description.workspace_scale;
  info.clutch_buttons = description.clutch_buttons;
  return info;
}

palpate_device_state_v1 unmeasured_state() noexcept {
  DeviceState nothing;
  nothing.tip.setConstant(DeviceState::kNotMeasured);
  nothing.armed = false;
  return struct_of(nothing);
}

DeviceState state_of(const palpate_device_state_v1& measured,
                     const DeviceDescription& description) noexcept {
  DeviceState state;
  state.time = measured.time;
  state.tip = Eigen::Vector3d(measured.tip);
  state.joints = Eigen::Vector3d(measured.joints);
  state.delivered_force = Eigen::Vector3d(measured.force);
  state.heat = Eigen::Vector3d(measured.heat);
  state.reference_force = Eigen::Vector3d(measured.reference_force);
  state.velocity = Eigen::Vector3d(measured.velocity);
  state.orientation = Eigen::Vector4d(measured.orientation);
  state.buttons = measured.buttons;
  state.armed = !description.reports_armed || (measured.flags & PALPATE_DEVICE_ARMED) != 0;
  state.clutched = (measured.flags & PALPATE_DEVICE_CLUTCHED) != 0;
  return state;
}

palpate_device_state_v1 struct_of(const DeviceState& state) noexcept {
  palpate_device_state_v1 measured{};
  measured.size = sizeof(measured);
  measured.time = state.time;
  std::fill(std::begin(measured.joints), std::end(measured.joints), DeviceState::kNotMeasured);
  put(state.tip, measured.tip);
  put(state.joints, measured.joints);
  put(state.delivered_force, measured.force);
  put(state.heat, measured.heat);
  put(state.reference_force, measured.reference_force);
  put(state.velocity, measured.velocity);
  put(state.orientation, measured.orientation);
  measured.buttons = state.buttons;
  if (state.armed) measured.flags |= PALPATE_DEVICE_ARMED;
  if (state.clutched) measured.flags |= PALPATE_DEVICE_CLUTCHED;
  return measured;
}

palpate_device_command_v1 struct_of(const DeviceCommand& command) noexcept {
  palpate_device_command_v1 sent{};
  sent.size = sizeof(sent);
  put(command.force, sent.force);
  put(command.torque, sent.torque);
  sent.lease = command.lease;
  return sent;
}

DeviceCommand command_of(const palpate_device_command_v1& command) noexcept {
  return {.force = Eigen::Vector3d(command.force),
          .lease = command.lease,
          .torque = Eigen::Vector3d(command.torque)};
}

}  // namespace palpate::devices
