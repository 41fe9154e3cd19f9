// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "palpate/devices/device.h"

namespace palpate::devices {

struct RemoteDeviceOptions {
  std::map<std::string, std::string> driver = {};  ///< options of the driver
  unsigned number = 0;                             ///< of the device, for drivers of several
  /// The program `palpate-device-host`; empty: beside this program, otherwise on the path.
  std::filesystem::path host = {};
  double open_timeout = 10;  ///< [s] until the device is connected or armed; > 0
  /// [s] > 0 until a read counts as unanswered. At least 20 periods are waited.
  double read_timeout = 0.02;
  /// The process asks for SCHED_FIFO when it is armed; without, a loaded machine lets it wait.
  bool real_time = false;
};

/// A driver as `PluginDevice`, but in a process of its own: a driver that crashes, stalls or writes
/// to foreign memory does not affect this program. The host drops the force itself when a lease
/// ends, unless the driver hangs inside a call: then only the device's own watchdog can. A tick
/// takes two messages and two changes of process longer than with `PluginDevice`.
class RemoteDevice final : public Device {
 public:
  /// \throws FileError if the host program is missing, or as `PluginDevice`.
  /// \throws InvalidInput on an option outside its range.
  /// \throws DeviceError with the words of the host or the driver, or how the process ended.
  explicit RemoteDevice(const std::filesystem::path& library,
                        const RemoteDeviceOptions& options = {});
  /// Ends the process; one that does not end within a second is killed.
  ~RemoteDevice() override;

  [[nodiscard]] const DeviceDescription& description() const noexcept override;
  [[nodiscard]] double now() const noexcept override;
  void activate() override;
  [[nodiscard]] bool read(DeviceState& state) noexcept override;
  /// False if the process has ended, or the driver refused the command before.
  [[nodiscard]] bool write(const DeviceCommand& command) noexcept override;
  void stop() noexcept override;
  [[nodiscard]] std::string last_error() const override;

 private:
  struct Process;
  std::unique_ptr<Process> process_;
};

}  // namespace palpate::devices
