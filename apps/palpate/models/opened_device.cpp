// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "models/opened_device.h"

#include <algorithm>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/haptics/held_arm.h"
#include "palpate/haptics/simulated_hand.h"
#include "palpate/haptics/trajectory_device.h"
#include "palpate/haptics/trajectory_file.h"
#include "palpate/probing/plugin_arm.h"
#include "palpate/probing/remote_arm.h"

namespace palpate::apps {
namespace {

/// The trajectory as a path of the device: it is given in the object's frame.
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

}  // namespace

OpenedDevice open_driver(const DeviceCall& call) {
  const fs::path library = fs::absolute(call.device);
  const std::map<std::string, std::string> settings = device_settings(call);
  if (call.in_process) {
    return {std::make_unique<probing::PluginArm>(library, settings, call.number)};
  }
  return {std::make_unique<probing::RemoteArm>(
      library, probing::RemoteArmOptions{
                   .driver = settings, .number = call.number, .real_time = call.real_time})};
}

OpenedDevice open_device(const DeviceCall& call, const haptics::DeviceLoopOptions& options) {
  if (is_driver(call.device)) return open_driver(call);
  const haptics::HandOptions hand = hand_options(call);
  const bool recorded = call.device == kRecorded;
  haptics::TimedPath path =
      path_of(call, options, recorded ? haptics::PathShape::linear : haptics::PathShape::smooth);
  const double duration = std::max(path.duration(), hand.period);
  if (call.device == kHand) {
    return {std::make_unique<haptics::SimulatedHand>(std::move(path), hand), duration};
  }
  if (call.device == kHeldArm) {
    return {std::make_unique<haptics::HeldArm>(std::move(path), hand), duration};
  }
  return {std::make_unique<haptics::TrajectoryDevice>(
              std::move(path),
              haptics::TrajectoryDeviceOptions{.period = hand.period, .real_time = call.real_time}),
          duration};
}

}  // namespace palpate::apps
