// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "palpate/devices/device.h"
#include "palpate/haptics/device_loop.h"
#include "palpate/haptics/playback.h"
#include "palpate/haptics/simulated_hand.h"
#include "palpate/haptics/virtual_coupling.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// A call of `palpate play` with a device.
struct DeviceCall {
  std::string device;  ///< recorded, scripted, hand, arm, or the driver of a device
  fs::path model, trajectory, trace, session, pose, exchange;
  std::string tool;  ///< name of the tool of a scene that the device moves; empty: the first one
  std::optional<double> begin;        ///< [s] time at which a simulated device begins to wait
  std::vector<std::string> settings;  ///< of the device, key=value
  unsigned number = 0;                ///< of the device, for drivers of several
  bool in_process = false;            ///< the driver runs in this process
  bool real_time = false;
  double duration = 0;     ///< [s]; 0: that of the trajectory, otherwise until Ctrl-C
  double exchange_at = 0;  ///< [s]
  std::optional<double> scale;
  haptics::PlaybackOptions playback;
  std::vector<unsigned> clutch_buttons;  ///< numbers from 0
  haptics::CouplingOptions coupling;
  devices::SafetyOptions safety;
};

// The simulated devices.
constexpr const char* kRecorded = "recorded";
constexpr const char* kScripted = "scripted";
constexpr const char* kHand = "hand";
constexpr const char* kHeldArm = "arm";

/// Returns true if the device is not a simulated one.
[[nodiscard]] bool is_driver(const std::string& device);

/// Checks that the driver's file exists. \throws FileError otherwise.
void check_driver(const std::string& device);

/// The settings of the simulated hand: "mass [kg], damping [N s/mm], ...".
[[nodiscard]] std::string hand_settings_in_words();

/// The settings of a simulated device. \throws InvalidInput for one that it does not have.
[[nodiscard]] haptics::HandOptions hand_options(const DeviceCall& call);

struct OpenedDevice {
  std::unique_ptr<devices::Device> arm;
  double duration = 0;  ///< [s] of its path; 0: without end
};

/// Opens the simulated device or the driver that a call names.
/// \throws InvalidInput on settings that it does not have, or without a trajectory that it needs.
[[nodiscard]] OpenedDevice open_device(const DeviceCall& call,
                                       const haptics::DeviceLoopOptions& options);

/// The same for drivers only.
[[nodiscard]] OpenedDevice open_driver(const DeviceCall& call);

}  // namespace palpate::apps
