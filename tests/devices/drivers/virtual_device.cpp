// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0

// A complete driver of an arm with joints: the virtual arm over a sheet, behind the C table. It has
// its own clock, so that a campaign takes as long as the simulation.
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <memory>
#include <new>
#include <string>

#include "palpate/devices/device_plugin.h"
#include "palpate/probing/arm_setup.h"
#include "palpate/probing/closed_form.h"
#include "palpate/probing/virtual_arm.h"

namespace {

using palpate::devices::DeviceState;
using palpate::probing::VirtualArm;
using palpate::probing::VirtualArmOptions;

struct Device {
  std::shared_ptr<const palpate::probing::Specimen> sheet =
      palpate::probing::make_specimen(palpate::probing::Sheet{});
  VirtualArmOptions options;
  std::unique_ptr<VirtualArm> arm;
  long long fail_at = -1;  // number of the state that cannot be read
  std::string fail_once;   // file that is made then, and with which it does not fail any more
  std::string moved;       // file that says by how many mm the sheet was moved towards the arm
  long long states = 0;
  std::string error;

  void renew() {
    options.T_world_base = palpate::probing::mount_over(sheet->surface(), options.geometry);
    double up = 0;
    if (std::ifstream file(moved); file >> up)
      options.T_world_base.translation() -= up * options.T_world_base.linear().col(1);
    arm = std::make_unique<VirtualArm>(sheet.get(), options);
  }
};

std::string failure_of_open;

int fail(Device& device, const char* words) {
  device.error = words;
  return 1;
}

int open_device(void** device, palpate_device_info_v1* info) {
  try {
    auto made = std::make_unique<Device>();
    made->renew();
    const palpate::devices::DeviceDescription& description = made->arm->description();
    info->capabilities = PALPATE_DEVICE_MEASURES_JOINTS | PALPATE_DEVICE_MEASURES_FORCE |
                         PALPATE_DEVICE_MEASURES_HEAT | PALPATE_DEVICE_MEASURES_REFERENCE;
    info->joints = 3;
    std::snprintf(info->name, sizeof(info->name), "virtual device");
    info->period = description.period;
    info->highest_force = description.highest_force;
    info->continuous_force = description.continuous_force;
    *device = made.release();
    return 0;
  } catch (const std::exception& wrong) {
    failure_of_open = wrong.what();
    return 1;
  }
}

int configure_device(void* device, const char* key, const char* value) {
  auto& d = *static_cast<Device*>(device);
  if (std::string(key) == "seed") {
    d.options.seed = std::strtoull(value, nullptr, 10);
  } else if (std::string(key) == "fail_at") {
    d.fail_at = std::atoll(value);
  } else if (std::string(key) == "fail_once") {
    d.fail_once = value;
  } else if (std::string(key) == "moved") {
    d.moved = value;
  } else {
    return fail(d, "the options are seed, fail_at, fail_once and moved");
  }
  d.renew();
  return 0;
}

int activate_device(void* device) {
  static_cast<Device*>(device)->arm->activate();
  return 0;
}

int read_device(void* device, palpate_device_state_v1* state) {
  auto& d = *static_cast<Device*>(device);
  if (d.states++ == d.fail_at && !std::ifstream(d.fail_once)) {
    if (!d.fail_once.empty()) std::ofstream(d.fail_once) << "once";
    return fail(d, "cable pulled");
  }
  DeviceState measured;
  if (!d.arm->read(measured)) return fail(d, "no equilibrium");
  state->time = measured.time;
  for (int i = 0; i < 3; ++i) {
    state->tip[i] = measured.tip[i];
    state->joints[i] = measured.joints[i];
    state->force[i] = measured.delivered_force[i];
    state->heat[i] = measured.heat[i];
  }
  if (state->size < offsetof(palpate_device_state_v1, reference_force) + 3 * sizeof(double))
    return 0;
  for (int i = 0; i < 3; ++i) state->reference_force[i] = measured.reference_force[i];
  return 0;
}

int write_device(void* device, const palpate_device_command_v1* command) {
  auto& d = *static_cast<Device*>(device);
  const bool taken =
      d.arm->write({.force = Eigen::Vector3d(command->force), .lease = command->lease});
  return taken ? 0 : fail(d, "write before activate");
}

int stop_device(void* device) {
  static_cast<Device*>(device)->arm->stop();
  return 0;
}

void close_device(void* device) { delete static_cast<Device*>(device); }

const char* last_error_of_device(void* device) {
  return device != nullptr ? static_cast<Device*>(device)->error.c_str() : failure_of_open.c_str();
}

double now_of_device(void* device) { return static_cast<Device*>(device)->arm->now(); }

}  // namespace

extern "C" const palpate_device_v1* palpate_device(void) {
  static const palpate_device_v1 table = {sizeof(palpate_device_v1),
                                          PALPATE_DEVICE_VERSION,
                                          open_device,
                                          configure_device,
                                          activate_device,
                                          read_device,
                                          write_device,
                                          stop_device,
                                          close_device,
                                          last_error_of_device,
                                          now_of_device,
                                          nullptr,
                                          nullptr};
  return &table;
}
