// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0

// A driver that goes wrong in the tick that its option "at" says, as its option "fault" says:
// crash, stall, hang, nan, refuse, group (its process group as y), or deaf: from then on it takes
// no command. With the fault keep it takes one force, shows it as y, and refuses all commands until
// stop. Its option "stopped" names a file that stop makes. Built with BROKEN_ON_LOAD it crashes
// while it is loaded.
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>
#include <thread>

#include "palpate/devices/device_plugin.h"

namespace {

struct Device {
  std::string fault, stopped;
  long at = -1, tick = 0;
  double kept = 0;  // [N]
  int asked = 0;    // for the last error
  std::string words;
};

#ifdef BROKEN_ON_LOAD
[[maybe_unused]] const bool loaded = (std::abort(), true);
#endif

int open_device(void** device, palpate_device_info_v1* info) {
  *device = new Device;
  info->period = 1e-3;
  info->highest_force = 5;
  info->continuous_force = 5;
  return 0;
}

int configure_device(void* device, const char* key, const char* value) {
  auto& d = *static_cast<Device*>(device);
  if (std::string(key) == "at") d.at = std::atol(value);
  if (std::string(key) == "fault") d.fault = value;
  if (std::string(key) == "stopped") d.stopped = value;
  return 0;
}

int read_device(void* device, palpate_device_state_v1* state) {
  auto& d = *static_cast<Device*>(device);
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
  state->time =
      std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  for (double& coordinate : state->tip) coordinate = 0;
  if (d.fault == "keep") state->tip[1] = d.kept;
  if (d.tick++ != d.at) return 0;
  if (d.fault == "crash") std::abort();
  if (d.fault == "stall") std::this_thread::sleep_for(std::chrono::milliseconds(150));
  if (d.fault == "hang") std::this_thread::sleep_for(std::chrono::hours(1));
  if (d.fault == "nan") state->tip[1] = std::numeric_limits<double>::quiet_NaN();
  if (d.fault == "group") state->tip[1] = static_cast<double>(getpgrp());
  return d.fault == "refuse" ? 1 : 0;
}

int do_nothing(void*) { return 0; }
int stop_device(void* device) {
  auto& d = *static_cast<Device*>(device);
  d.kept = 0;
  if (!d.stopped.empty()) std::ofstream(d.stopped) << "stopped";
  return 0;
}
int write_device(void* device, const palpate_device_command_v1* command) {
  auto& d = *static_cast<Device*>(device);
  if (d.fault == "keep") {
    if (d.kept != 0) return 1;
    d.kept = command->force[0];
  }
  if (d.fault == "deaf" && d.tick > d.at) return 1;
  return std::isfinite(command->force[0]) ? 0 : 1;
}
void close_device(void* device) { delete static_cast<Device*>(device); }
const char* last_error_of_device(void* device) {
  auto* d = static_cast<Device*>(device);
  if (d == nullptr || d->fault != "keep") return "broken as told";
  d->words = "keeps its force, asked " + std::to_string(++d->asked) + " times";
  return d->words.c_str();
}

// The second device says that its forces have no limit.
uint32_t count_devices() { return 2; }
int open_numbered(uint32_t, void** device, palpate_device_info_v1* info) {
  const int failed = open_device(device, info);
  info->highest_force = std::numeric_limits<double>::infinity();
  return failed;
}

}  // namespace

extern "C" const palpate_device_v1* palpate_device(void) {
  static const palpate_device_v1 table = {sizeof(palpate_device_v1),
                                          PALPATE_DEVICE_VERSION,
                                          open_device,
                                          configure_device,
                                          do_nothing,
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
