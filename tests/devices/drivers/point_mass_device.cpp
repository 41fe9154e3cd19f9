// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0

// A complete driver: a simulated device with a point mass as its tip, which stands for hardware.
// Copy this file to begin a driver of your own; it uses nothing of Palpate but the header.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <new>
#include <string>
#include <thread>

#include "palpate/devices/device_plugin.h"

namespace {

double monotonic_time() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct Device {
  double mass = 0.1;      // [kg]
  double friction = 0.5;  // [N s/m]
  double period = 1e-3;   // [s]
  bool active = false;
  bool forgets_lease = false;                       // as a vendor's service may do
  double time = 0;                                  // [s] of the latest state
  double lease_end = 0;                             // [s]
  double torque = 0;                                // [N mm]
  std::array<double, 3> force{}, place{}, speed{};  // [N], [mm], [mm/s]
  std::string error;
};

std::string failure_of_open;

int fail(Device& device, const char* words) {
  device.error = words;
  return 1;
}

int open_device(void** device, palpate_device_info_v1* info) {
  auto* made = new (std::nothrow) Device;
  *device = made;
  if (made == nullptr) {
    failure_of_open = "no memory";
    return 1;
  }
  made->error.reserve(64);
  info->capabilities = PALPATE_DEVICE_MEASURES_FORCE;
  info->joints = 0;
  std::snprintf(info->name, sizeof(info->name), "point mass");
  info->period = made->period;
  info->highest_force = 5;
  info->continuous_force = 5;
  if (info->size >= sizeof(*info)) {
    info->capabilities |= PALPATE_DEVICE_MEASURES_VELOCITY | PALPATE_DEVICE_MEASURES_ORIENTATION |
                          PALPATE_DEVICE_APPLIES_TORQUE | PALPATE_DEVICE_REPORTS_ARMED;
    info->highest_torque = 80;
    info->damping = 0.001 * made->friction;
    info->friction = 0.04;
    info->resolution = 0.01;
    info->delay = made->period;
    info->workspace_scale = 3;
    info->buttons = 2;
    info->clutch_buttons = 2;
  }
  return 0;
}

// Two devices, of which the second is the stronger.
uint32_t count_devices() { return 2; }

int open_numbered(uint32_t number, void** device, palpate_device_info_v1* info) {
  const int failed = open_device(device, info);
  if (number == 1) info->highest_force = 9;
  return failed;
}

int configure_device(void* device, const char* key, const char* value) {
  auto& d = *static_cast<Device*>(device);
  if (std::string(key) == "forget_lease") {
    d.forgets_lease = true;
    return 0;
  }
  if (std::string(key) != "mass") return fail(d, "the options are mass and forget_lease");
  const double mass = std::atof(value);
  if (!(mass > 0)) return fail(d, "mass must be > 0 kg");
  d.mass = mass;
  return 0;
}

int activate_device(void* device) {
  auto& d = *static_cast<Device*>(device);
  d.active = true;
  d.time = monotonic_time();
  d.force = {};
  return 0;
}

int read_device(void* device, palpate_device_state_v1* state) {
  auto& d = *static_cast<Device*>(device);
  if (d.time == 0) return fail(d, "read before activate");
  std::this_thread::sleep_until(std::chrono::steady_clock::time_point(
      std::chrono::duration_cast<std::chrono::steady_clock::duration>(
          std::chrono::duration<double>(d.time + d.period))));
  const double now = monotonic_time();
  const double step = std::min(now - d.time, 0.01);
  const bool powered = d.active && (now <= d.lease_end || d.forgets_lease);
  for (std::size_t i = 0; i < 3; ++i) {
    const double force = powered ? d.force[i] : 0;
    d.speed[i] += step * (1000 * force - d.friction * d.speed[i]) / d.mass;
    d.place[i] += step * d.speed[i];
    state->tip[i] = d.place[i];
    state->force[i] = force + 1e-6;
  }
  d.time = now;
  state->time = now;
  if (state->size < sizeof(*state)) return 0;
  for (std::size_t i = 0; i < 3; ++i) state->velocity[i] = d.speed[i];
  state->orientation[0] = 1;
  for (std::size_t i = 1; i < 4; ++i) state->orientation[i] = 0;
  // The torque on the handle presses its buttons: 1 N mm the first, 2 N mm the second.
  state->buttons = static_cast<uint32_t>(d.torque);
  state->flags = d.active ? PALPATE_DEVICE_ARMED : 0;
  return 0;
}

int write_device(void* device, const palpate_device_command_v1* command) {
  auto& d = *static_cast<Device*>(device);
  if (!d.active) return fail(d, "write before activate");
  for (std::size_t i = 0; i < 3; ++i) d.force[i] = command->force[i];
  if (command->size >= sizeof(*command)) d.torque = command->torque[2];
  d.lease_end = monotonic_time() + command->lease;
  return 0;
}

int stop_device(void* device) {
  static_cast<Device*>(device)->active = false;
  return 0;
}

void close_device(void* device) { delete static_cast<Device*>(device); }

const char* last_error_of_device(void* device) {
  return device != nullptr ? static_cast<Device*>(device)->error.c_str() : failure_of_open.c_str();
}

}  // namespace

#ifndef POINT_MASS_VERSION
#define POINT_MASS_VERSION PALPATE_DEVICE_VERSION
#endif

extern "C" const palpate_device_v1* palpate_device(void) {
  static const palpate_device_v1 table = {sizeof(palpate_device_v1),
                                          POINT_MASS_VERSION,
                                          open_device,
                                          configure_device,
                                          activate_device,
                                          read_device,
                                          write_device,
                                          stop_device,
                                          close_device,
                                          last_error_of_device,
                                          nullptr,
                                          count_devices,
                                          open_numbered};
  return &table;
}
