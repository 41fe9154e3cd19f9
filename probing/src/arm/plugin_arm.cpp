// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/plugin_arm.h"

#include <dlfcn.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <string>

#include "palpate/error.h"
#include "palpate/probing/device_plugin.h"

namespace palpate::probing {

struct PluginArm::Driver {
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
  ArmDescription description;
};

namespace {

/// [bytes] Size of the table without the optional functions.
constexpr std::size_t kLeastTable = offsetof(palpate_device_v1, now);

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

void check_info(const palpate_device_info_v1& info, const std::string& file) {
  if (!(info.period > 0) || !(info.highest_force > 0) || !(info.continuous_force > 0) ||
      !std::isfinite(info.period) || info.joints > PALPATE_DEVICE_JOINTS) {
    throw DeviceError(
        file + ": the driver describes a device that cannot be: period " +
        std::to_string(info.period) + " s, forces " + std::to_string(info.highest_force) + " and " +
        std::to_string(info.continuous_force) + " N, " + std::to_string(info.joints) + " joints");
  }
}

}  // namespace

PluginArm::PluginArm(const std::filesystem::path& library,
                     const std::map<std::string, std::string>& options)
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
                    ": has no function palpate_device(); see palpate/probing/device_plugin.h");
  }
  driver.table = reinterpret_cast<palpate_device_function>(symbol)();
  check_table(driver.table, driver.name());
  if (driver.table->size >= sizeof(palpate_device_v1)) driver.clock = driver.table->now;
  driver.info.size = sizeof(driver.info);
  if (driver.table->open(&driver.device, &driver.info) != 0 || driver.device == nullptr) {
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
  driver.info.name[sizeof(driver.info.name) - 1] = '\0';
  const auto can = [&](unsigned bit) { return (driver.info.capabilities & bit) != 0; };
  driver.description = {
      .name = static_cast<const char*>(driver.info.name),
      .period = driver.info.period,
      .highest_force = driver.info.highest_force,
      .continuous_force = driver.info.continuous_force,
      .measures_joints = can(PALPATE_DEVICE_MEASURES_JOINTS) && driver.info.joints >= 3,
      .measures_force = can(PALPATE_DEVICE_MEASURES_FORCE),
      .measures_heat = can(PALPATE_DEVICE_MEASURES_HEAT),
      .measures_reference = can(PALPATE_DEVICE_MEASURES_REFERENCE),
      .real_time = driver.clock == nullptr};
}

PluginArm::~PluginArm() = default;

const ArmDescription& PluginArm::description() const noexcept { return driver_->description; }

double PluginArm::now() const noexcept {
  if (driver_->clock != nullptr) return driver_->clock(driver_->device);
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void PluginArm::activate() {
  if (driver_->table->activate(driver_->device) != 0) {
    throw DeviceError(driver_->name() + ": " + last_error());
  }
}

bool PluginArm::read(ArmState& state) noexcept {
  palpate_device_state_v1 measured{};
  measured.size = sizeof(measured);
  const auto forget = [](double& value) { value = ArmState::kNotMeasured; };
  std::for_each(std::begin(measured.tip), std::end(measured.tip), forget);
  std::for_each(std::begin(measured.joints), std::end(measured.joints), forget);
  std::for_each(std::begin(measured.force), std::end(measured.force), forget);
  std::for_each(std::begin(measured.heat), std::end(measured.heat), forget);
  std::for_each(std::begin(measured.reference_force), std::end(measured.reference_force), forget);
  if (driver_->table->read(driver_->device, &measured) != 0) return false;
  state.time = measured.time;
  state.tip = Eigen::Vector3d(measured.tip);
  state.joints = Eigen::Vector3d(measured.joints);
  state.delivered_force = Eigen::Vector3d(measured.force);
  state.heat = Eigen::Vector3d(measured.heat);
  state.reference_force = Eigen::Vector3d(measured.reference_force);
  return true;
}

bool PluginArm::write(const ArmCommand& command) noexcept {
  palpate_device_command_v1 sent{};
  sent.size = sizeof(sent);
  for (int i = 0; i < 3; ++i) sent.force[i] = command.force[i];
  sent.lease = command.lease;
  return driver_->table->write(driver_->device, &sent) == 0;
}

void PluginArm::stop() noexcept { driver_->table->stop(driver_->device); }

std::string PluginArm::last_error() const {
  const char* words = driver_->table->last_error(driver_->device);
  return words != nullptr ? words : "the driver does not say why";
}

}  // namespace palpate::probing
