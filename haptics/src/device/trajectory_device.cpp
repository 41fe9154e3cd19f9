// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/trajectory_device.h"

#include <utility>

#include "device/tick_clock.h"
#include "palpate/core/require.h"

namespace palpate::haptics {

struct TrajectoryDevice::Player {
  TimedPath path;
  double period;
  TickClock clock;
  devices::DeviceDescription description;
  bool active = false;
};

TrajectoryDevice::TrajectoryDevice(TimedPath path, const TrajectoryDeviceOptions& options) {
  require("TrajectoryDeviceOptions::period", options.period, above(0).finite(), "s");
  require("TrajectoryDeviceOptions::highest_force", options.highest_force, above(0).finite(), "N");
  player_ =
      std::make_unique<Player>(Player{.path = std::move(path),
                                      .period = options.period,
                                      .clock = TickClock(options.period, options.real_time),
                                      .description = {.name = "trajectory",
                                                      .period = options.period,
                                                      .highest_force = options.highest_force,
                                                      .continuous_force = options.highest_force,
                                                      .real_time = options.real_time}});
}

TrajectoryDevice::~TrajectoryDevice() = default;

const devices::DeviceDescription& TrajectoryDevice::description() const noexcept {
  return player_->description;
}

double TrajectoryDevice::now() const noexcept { return player_->clock.now(); }

void TrajectoryDevice::activate() { player_->active = true; }

bool TrajectoryDevice::read(devices::DeviceState& state) noexcept {
  player_->clock.wait();
  state = {};
  state.time = player_->clock.now();
  state.tip =
      player_->path.position(static_cast<double>(player_->clock.ticks() - 1) * player_->period);
  return true;
}

bool TrajectoryDevice::write(const devices::DeviceCommand& command) noexcept {
  return player_->active && command.force.allFinite();
}

void TrajectoryDevice::stop() noexcept { player_->active = false; }

}  // namespace palpate::haptics
