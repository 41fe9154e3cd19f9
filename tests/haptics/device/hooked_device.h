// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "palpate/core/error.h"
#include "palpate/devices/device.h"

namespace palpate::haptics {

/// Another device with a hook in its functions, to make it fail or to watch it.
class HookedDevice final : public devices::Device {
 public:
  explicit HookedDevice(devices::Device& device) : device_(device) {}

  /// Called after each read with its number from 0; returns whether the device answered.
  std::function<bool(long long, devices::DeviceState&)> after_read = [](long long, auto&) {
    return true;
  };
  bool armed = false;
  bool unplugged = false;  ///< each read fails at once
  std::function<void(const devices::DeviceCommand&)> on_write = [](const devices::DeviceCommand&) {
  };
  std::function<bool(const devices::DeviceCommand&)> takes = [](const auto&) { return true; };

  [[nodiscard]] const devices::DeviceDescription& description() const noexcept override {
    return device_.description();
  }
  [[nodiscard]] double now() const noexcept override { return device_.now(); }
  void activate() override {
    if (unplugged) throw DeviceError(last_error());
    device_.activate();
    armed = true;
  }
  [[nodiscard]] bool read(devices::DeviceState& state) noexcept override {
    return !unplugged && device_.read(state) && after_read(reads_++, state);
  }
  [[nodiscard]] bool write(const devices::DeviceCommand& command) noexcept override {
    on_write(command);
    return takes(command) && device_.write(command);
  }
  void stop() noexcept override {
    armed = false;
    device_.stop();
  }
  [[nodiscard]] std::string last_error() const override { return "cable pulled"; }

 private:
  devices::Device& device_;
  long long reads_ = 0;
};

}  // namespace palpate::haptics
