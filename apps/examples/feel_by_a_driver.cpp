// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// A model is felt for two seconds with a device whose driver runs in a process of its own, so that
// its crash would not be that of this program: feel_by_a_driver MODEL DRIVER HOST. DRIVER is a
// shared library (docs/devices.md), HOST the program palpate-device-host.
#include <palpate/core/error.h>
#include <palpate/devices/remote_device.h>
#include <palpate/haptics/device_run.h>
#include <palpate/haptics/model_io.h>

#include <cstdio>

namespace haptics = palpate::haptics;

int main(int count, char** arguments) try {
  if (count != 4) throw palpate::InvalidInput("usage: feel_by_a_driver MODEL DRIVER HOST");
  const haptics::Model model = haptics::read_model(arguments[1]);
  palpate::devices::RemoteDevice device(arguments[2], {.host = arguments[3], .real_time = true});

  haptics::DeviceLoopOptions options;  // the device's origin lies in the middle of the surface
  options.T_world_device.translation() = model.contacts[model.contacts.size() / 2].position;
  haptics::DeviceRun run(device, std::make_shared<const haptics::Playback>(model), options,
                         {.duration = 2});
  const haptics::RunReport report = run.finish();
  std::printf("%s: %lld ticks at %.0f Hz, %lld with contact, largest force %.2f N\n",
              device.description().name.c_str(), report.time.ticks, report.time.rate,
              report.states[1] + report.states[2], report.largest_force);
  if (!report.not_real_time.empty()) {
    std::printf("without real-time scheduling: %s\n", report.not_real_time.c_str());
  }
} catch (const palpate::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
