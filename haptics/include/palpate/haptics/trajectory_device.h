// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "palpate/devices/device.h"
#include "palpate/haptics/timed_path.h"

namespace palpate::haptics {

struct TrajectoryDeviceOptions {
  double period = 1e-3;       ///< [s] > 0
  bool real_time = false;     ///< on the host's clock; otherwise on its own, as fast as it is read
  double highest_force = 10;  ///< [N] > 0
};

/// A device that follows a path whatever force it is commanded: scripted (`PathShape::smooth`) or
/// recorded (`PathShape::linear`). Its first state is the beginning of the path.
class TrajectoryDevice final : public devices::Device {
 public:
  /// \throws InvalidInput on an option outside its range.
  explicit TrajectoryDevice(TimedPath path, const TrajectoryDeviceOptions& options = {});
  ~TrajectoryDevice() override;

  [[nodiscard]] const devices::DeviceDescription& description() const noexcept override;
  [[nodiscard]] double now() const noexcept override;
  void activate() override;
  [[nodiscard]] bool read(devices::DeviceState& state) noexcept override;
  [[nodiscard]] bool write(const devices::DeviceCommand& command) noexcept override;
  void stop() noexcept override;

 private:
  struct Player;
  std::unique_ptr<Player> player_;
};

}  // namespace palpate::haptics
