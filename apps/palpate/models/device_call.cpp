// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "models/device_call.h"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <string_view>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/field_text.h"
#include "palpate/devices/plugin_device.h"
#include "palpate/devices/remote_device.h"
#include "palpate/haptics/held_arm.h"
#include "palpate/haptics/trajectory_device.h"
#include "palpate/haptics/trajectory_file.h"
#include "shared/field_options.h"

namespace palpate::apps {
namespace {

/// The fields of `HandOptions` that are settings of a simulated device.
std::span<const std::string_view> known_settings(const std::string& device) {
  static constexpr std::array<std::string_view, 1> kOfPath{"rate"};
  static constexpr std::array<std::string_view, 3> kOfArm{"mass", "damping", "stiffness"};
  static constexpr std::array<std::string_view, 7> kOfHand{
      "mass", "damping", "friction", "stiffness", "encoder_step", "delay", "rate"};
  if (device == kHeldArm) return kOfArm;
  if (device == kHand) return kOfHand;
  return kOfPath;
}

std::string settings_in_words(std::span<const std::string_view> known) {
  haptics::HandOptions hand;
  std::string words;
  for (const FieldText& field : texts_of(fields_of(hand))) {
    if (std::ranges::find(known, field.name) == known.end()) continue;
    words += (words.empty() ? "" : ", ") + field.name + " [" + field.unit + "]";
  }
  return words;
}

/// Converts the trajectory, given in the object's frame, to a path of the device.
haptics::TimedPath path_of(const DeviceCall& call, const haptics::DeviceLoopOptions& options,
                           haptics::PathShape shape) {
  if (call.trajectory.empty()) {
    throw InvalidInput("--device " + call.device +
                       ": needs --trajectory, where the device or its hand shall go");
  }
  std::vector<haptics::TrajectoryPoint> points = haptics::read_trajectory_file(call.trajectory);
  if (call.begin && *call.begin < points.front().time)
    points.insert(points.begin(), {*call.begin, points.front().tool});
  const Eigen::Isometry3d T_device_world = options.T_world_device.inverse();
  const double scale = options.scale.value_or(1);
  for (haptics::TrajectoryPoint& point : points) point.tool = T_device_world * point.tool / scale;
  return haptics::TimedPath(std::move(points), shape);
}

/// The settings of a device by their keys. \throws InvalidInput if one is not KEY=VALUE.
std::map<std::string, std::string> device_settings(const DeviceCall& call) {
  std::map<std::string, std::string> settings;
  for (const std::string& word : call.settings) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw InvalidInput("--set " + word + ": must be KEY=VALUE, such as damping=0.002");
    }
    settings[word.substr(0, equals)] = word.substr(equals + 1);
  }
  return settings;
}

}  // namespace

bool is_driver(const std::string& device) {
  return device != kRecorded && device != kScripted && device != kHand && device != kHeldArm;
}

void check_driver(const std::string& device) {
  if (fs::is_regular_file(device)) return;
  throw FileError("--device " + device +
                  ": there is no such file; it must be recorded, scripted, hand, arm, or the "
                  "driver of a device, a shared library");
}

std::string hand_settings_in_words() { return settings_in_words(known_settings(kHand)); }

haptics::HandOptions hand_options(const DeviceCall& call) {
  haptics::HandOptions hand;
  hand.real_time = call.real_time;
  const std::span<const std::string_view> known = known_settings(call.device);
  for (const auto& [key, text] : device_settings(call)) {
    if (std::ranges::find(known, key) == known.end()) {
      throw InvalidInput("--set " + key + ": --device " + call.device + " has " +
                         settings_in_words(known));
    }
    with_names({{"HandOptions::" + key, "--set " + key}},
               [&, &key = key, &text = text] { assign(fields_of(hand), key, text); });
  }
  return hand;
}

OpenedDevice open_driver(const DeviceCall& call) {
  const fs::path library = fs::absolute(call.device);
  const std::map<std::string, std::string> settings = device_settings(call);
  if (call.in_process) {
    return {std::make_unique<devices::PluginDevice>(library, settings, call.number)};
  }
  return {std::make_unique<devices::RemoteDevice>(
      library, devices::RemoteDeviceOptions{
                   .driver = settings, .number = call.number, .real_time = call.real_time})};
}

OpenedDevice open_device(const DeviceCall& call, const haptics::DeviceLoopOptions& options) {
  if (is_driver(call.device)) return open_driver(call);
  const haptics::HandOptions hand = hand_options(call);
  const bool recorded = call.device == kRecorded;
  haptics::TimedPath path =
      path_of(call, options, recorded ? haptics::PathShape::linear : haptics::PathShape::smooth);
  const double duration = std::max(path.duration(), hand.period());
  if (call.device == kHand) {
    return {std::make_unique<haptics::SimulatedHand>(std::move(path), hand), duration};
  }
  if (call.device == kHeldArm) {
    return {std::make_unique<haptics::HeldArm>(std::move(path), hand), duration};
  }
  return {std::make_unique<haptics::TrajectoryDevice>(
              std::move(path), haptics::TrajectoryDeviceOptions{.period = hand.period(),
                                                                .real_time = call.real_time}),
          duration};
}

}  // namespace palpate::apps
