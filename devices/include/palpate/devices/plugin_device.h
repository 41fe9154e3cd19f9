// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "palpate/devices/device.h"

namespace palpate::devices {

/// A device whose driver is a shared library with the table of `device_plugin.h`.
class PluginDevice final : public Device {
 public:
  /// Loads the library, connects to the device and sets the options of the driver.
  /// \param number of the device, from 0, for drivers of several.
  /// \throws InvalidInput if the driver has no device of this number.
  /// \throws FileError if the file is no driver, or one for another version of the table.
  /// \throws DeviceError with the driver's words if it refuses to open or to take an option.
  explicit PluginDevice(const std::filesystem::path& library,
                        const std::map<std::string, std::string>& options = {},
                        unsigned number = 0);
  ~PluginDevice() override;

  [[nodiscard]] const DeviceDescription& description() const noexcept override;
  [[nodiscard]] double now() const noexcept override;
  void activate() override;
  [[nodiscard]] bool read(DeviceState& state) noexcept override;
  [[nodiscard]] bool write(const DeviceCommand& command) noexcept override;
  void stop() noexcept override;

  /// The driver's words about its latest failure.
  [[nodiscard]] std::string last_error() const override;

 private:
  struct Driver;
  std::unique_ptr<Driver> driver_;
};

}  // namespace palpate::devices
