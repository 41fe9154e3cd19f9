// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/devices/plugin_device.h"

#include <dlfcn.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <string>

#include "drivers/device_structs.h"
#include "palpate/core/error.h"
#include "palpate/devices/device_plugin.h"

namespace palpate::devices {

struct PluginDevice::Driver {
  ~Driver() {
    if (device != nullptr) {
      table->stop(device);
      table->close(device);
    }
    if (library != nullptr) dlclose(library);
  }

  [[nodiscard]] std::string name() const { return path.string(); }

  std::filesystem::path path;
  void* library = nullptr;
  const palpate_device_v1* table = nullptr;
  double (*clock)(void*) = nullptr;  // of the device, if it has one
  void* device = nullptr;
  palpate_device_info_v1 info{};
  DeviceDescription description;
};

namespace {

/// [bytes] Sizes of the table: without the functions that were added, and with them.
constexpr std::size_t kLeastTable = offsetof(palpate_device_v1, now);
constexpr std::size_t kTableWithClock = offsetof(palpate_device_v1, count);
constexpr std::size_t kTableWithSeveral = sizeof(palpate_device_v1);

/// \throws FileError unless the table is complete and of our version.
void check_table(const palpate_device_v1* table, const std::string& file) {
  if (table == nullptr) throw FileError(file + ": palpate_device() returned no table");
  if (table->version != PALPATE_DEVICE_VERSION) {
    throw FileError(file + ": the driver is for version " + std::to_string(table->version) +
                    " of device_plugin.h; this build needs version " +
                    std::to_string(PALPATE_DEVICE_VERSION) + ". Rebuild the driver");
  }
  if (table->size < kLeastTable) {
    throw FileError(file + ": the driver's table has " + std::to_string(table->size) +
                    " bytes; version " + std::to_string(PALPATE_DEVICE_VERSION) + " has at least " +
                    std::to_string(kLeastTable) + ". Rebuild the driver");
  }
  if (table->open == nullptr || table->configure == nullptr || table->activate == nullptr ||
      table->read == nullptr || table->write == nullptr || table->stop == nullptr ||
      table->close == nullptr || table->last_error == nullptr) {
    throw FileError(file + ": the driver's table lacks a function; all eight are needed");
  }
}

bool at_least_zero(double value) { return value >= 0 && std::isfinite(value); }

void check_info(const palpate_device_info_v1& info, const std::string& file) {
  if (!(info.period > 0) || !(info.highest_force > 0) || !(info.continuous_force > 0) ||
      !std::isfinite(info.period) || !std::isfinite(info.highest_force) ||
      !std::isfinite(info.continuous_force) || info.joints > PALPATE_DEVICE_JOINTS ||
      !at_least_zero(info.highest_torque) || !at_least_zero(info.damping) ||
      !at_least_zero(info.delay) || !at_least_zero(info.workspace_scale) ||
      !at_least_zero(info.friction) || !at_least_zero(info.resolution)) {
    throw DeviceError(
        file + ": the driver describes a device that cannot be: period " +
        std::to_string(info.period) + " s, forces " + std::to_string(info.highest_force) + " and " +
        std::to_string(info.continuous_force) + " N, " + std::to_string(info.joints) +
        " joints, torque " + std::to_string(info.highest_torque) + " N mm, damping " +
        std::to_string(info.damping) + " N s/mm, delay " + std::to_string(info.delay) +
        " s, workspace scale " + std::to_string(info.workspace_scale) + ", friction " +
        std::to_string(info.friction) + " N, resolution " + std::to_string(info.resolution) +
        " mm");
  }
}

}  // namespace

PluginDevice::PluginDevice(const std::filesystem::path& library,
                           const std::map<std::string, std::string>& options, unsigned number)
    : driver_(std::make_unique<Driver>()) {
  Driver& driver = *driver_;
  driver.path = library;
  driver.library = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (driver.library == nullptr) {
    throw FileError(driver.name() + ": is not a driver that can be loaded: " + dlerror());
  }
  void* symbol = dlsym(driver.library, PALPATE_DEVICE_SYMBOL);
  if (symbol == nullptr) {
    throw FileError(driver.name() +
                    ": has no function palpate_device(); see palpate/devices/device_plugin.h");
  }
  driver.table = reinterpret_cast<palpate_device_function>(symbol)();
  check_table(driver.table, driver.name());
  const auto reaches = [&](std::size_t end) { return driver.table->size >= end; };
  if (reaches(kTableWithClock)) driver.clock = driver.table->now;
  const bool several = reaches(kTableWithSeveral) && driver.table->count != nullptr &&
                       driver.table->open_at != nullptr;
  const unsigned devices = several ? driver.table->count() : 1;
  if (number >= devices) {
    throw InvalidInput(driver.name() + ": there is no device " + std::to_string(number) +
                       "; the driver finds " + std::to_string(devices) + ", counted from 0");
  }
  driver.info.size = sizeof(driver.info);
  const int failed = number == 0 ? driver.table->open(&driver.device, &driver.info)
                                 : driver.table->open_at(number, &driver.device, &driver.info);
  if (failed != 0 || driver.device == nullptr) {
    throw DeviceError(driver.name() + ": " + last_error());
  }
  check_info(driver.info, driver.name());
  const auto refused = std::find_if(options.begin(), options.end(), [&](const auto& option) {
    return driver.table->configure(driver.device, option.first.c_str(), option.second.c_str()) != 0;
  });
  if (refused != options.end()) {
    throw DeviceError(driver.name() + ": option " + refused->first + " = " + refused->second +
                      ": " + last_error());
  }
  driver.description = description_of(driver.info, driver.clock == nullptr);
}

PluginDevice::~PluginDevice() = default;

const DeviceDescription& PluginDevice::description() const noexcept { return driver_->description; }

double PluginDevice::now() const noexcept {
  if (driver_->clock != nullptr) return driver_->clock(driver_->device);
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void PluginDevice::activate() {
  if (driver_->table->activate(driver_->device) != 0) {
    throw DeviceError(driver_->name() + ": " + last_error());
  }
}

bool PluginDevice::read(DeviceState& state) noexcept {
  palpate_device_state_v1 measured = unmeasured_state();
  if (driver_->table->read(driver_->device, &measured) != 0) return false;
  state = state_of(measured, driver_->description);
  return true;
}

bool PluginDevice::write(const DeviceCommand& command) noexcept {
  const palpate_device_command_v1 sent = struct_of(command);
  return driver_->table->write(driver_->device, &sent) == 0;
}

void PluginDevice::stop() noexcept { driver_->table->stop(driver_->device); }

std::string PluginDevice::last_error() const {
  const char* words = driver_->table->last_error(driver_->device);
  return words != nullptr ? words : "the driver does not say why";
}

}  // namespace palpate::devices
