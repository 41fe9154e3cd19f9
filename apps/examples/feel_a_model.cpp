// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// Measurements become a model, and the model is felt at 1 kHz. Needs the measurements of an arm and
// the surface: feel_a_model contacts.csv samples.csv surface.ply. The device is a stand-in that
// presses 12 mm into the middle of the surface, within half a second. Writes the folder model, and
// prints the force at the end.
#include <palpate/core/error.h>
#include <palpate/geometry/mesh_io.h>
#include <palpate/haptics/build_model.h>
#include <palpate/haptics/model_io.h>
#include <palpate/haptics/playback.h>
#include <palpate/probing/acquisition_csv.h>

#include <cstdio>

namespace haptics = palpate::haptics;

/// Stands in for the driver of a haptic device.
struct Device {
  Eigen::Vector3d from, to;  // mm
  int tick = 0;
  Eigen::Vector3d felt = Eigen::Vector3d::Zero();  // N

  bool next_tick() { return tick++ < 500; }
  Eigen::Vector3d position() const { return from + (to - from) * tick / 500; }
  void apply(const Eigen::Vector3d& force) { felt = force; }
};

void feel(const std::filesystem::path& model, Device& device) {
  const haptics::Playback playback(haptics::read_model(model));
  haptics::LoopState state;
  while (device.next_tick()) {                                                 // every millisecond
    const haptics::Command command = playback.step(device.position(), state);  // mm
    device.apply(command.force);                                               // N, on the user
  }
}

int main(int count, char** arguments) try {
  if (count != 4) throw palpate::InvalidInput("usage: feel_a_model CONTACTS SAMPLES SURFACE");
  const auto measured = palpate::probing::read_acquisition_csv(arguments[1], arguments[2]);
  const haptics::Model model =
      haptics::build_model(measured, palpate::geometry::read_mesh(arguments[3])).model;
  haptics::write_model("model", model);

  const Eigen::Vector3d middle = model.contacts[model.contacts.size() / 2].position;
  Device device{middle - 2 * Eigen::Vector3d::UnitZ(), middle + 12 * Eigen::Vector3d::UnitZ()};
  feel("model", device);
  std::printf("12 mm deep, the user feels %.2f, %.2f, %.2f N\n", device.felt.x(), device.felt.y(),
              device.felt.z());
} catch (const palpate::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
