// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "shared/command_line.h"

namespace palpate::apps {

/// What `palpate play` with a device is asked to do.
struct DeviceCall {
  std::string device;  ///< recorded, scripted, hand, arm, or the driver of a device
  std::filesystem::path model, trajectory, trace, session, pose, exchange;
  std::vector<std::string> settings;  ///< of the device, key=value
  unsigned number = 0;                ///< of the device, for drivers of several
  bool in_process = false;            ///< the driver runs in this process
  bool real_time = false;
  double duration = 0;     ///< [s]; 0: that of the trajectory, otherwise until Ctrl-C
  double exchange_at = 0;  ///< [s]
  std::optional<double> scale;
  std::vector<unsigned> clutch_buttons;         ///< numbers from 0
  std::string coupling = "auto";                ///< auto, off, or a stiffness [N/mm]
  double force = 3.3, slew = 1000, ramp = 0.5;  ///< as in `haptics::SafetyOptions`
};

/// Runs the loop between a device and a model.
void play_device(const Settings& settings, const DeviceCall& call);

/// Says for a model and a device which stiffness is calm, and which rate and damping it needs.
void play_stability(const Settings& settings, const DeviceCall& call);

/// Computes a session again. \throws Error if it differs.
void play_replay(const Settings& settings, const std::filesystem::path& model,
                 const std::filesystem::path& exchange, const std::filesystem::path& session);

}  // namespace palpate::apps
