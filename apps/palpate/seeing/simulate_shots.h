// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/virtual_sensor.h"
#include "seeing/simulate_report.h"
#include "seeing/simulate_scene.h"
#include "shards/shard.h"

namespace palpate::apps {

/// A call of `simulate`.
struct SimulateCall {
  SceneCall scene;
  fs::path rig, pattern, decoder_rig, sensor_file, output;
  std::vector<double> distances;
  bool ideal = false, report = false;
  sensing::VirtualSensor sensor;             ///< the fields that were given
  std::vector<CLI::Option*> sensor_options;  ///< one per field
  std::optional<Shard> shard;
};

/// A frame: a mesh of the sequence at a distance.
struct Shot {
  std::size_t mesh = 0;
  std::optional<double> distance;
};

/// The input that all frames have in common.
struct SimulateSetup {
  sensing::Rig rig, decoder_rig;
  sensing::Pattern pattern;
  std::vector<cv::Mat> panels;  ///< the images that the projector shows in each shot
  sensing::VirtualSensor sensor;
  std::vector<Shot> shots;
};

/// Reads the input that all frames have in common.
/// \throws FileError or InvalidInput if a file is damaged, or does not suit another one.
[[nodiscard]] SimulateSetup read_setup(const SimulateCall& call);

/// The images of the pattern, which lie beside its file.
[[nodiscard]] std::vector<fs::path> panel_files(const SimulateCall& call,
                                                const sensing::Pattern& pattern);

/// Writes rig and sensor.
void write_setup(const SimulateSetup& setup, const fs::path& output);

/// The files and figures of a frame that was written.
struct SimulatedShot {
  std::optional<ReportLine> line = {};  ///< if there is a report
  std::vector<fs::path> files = {};     ///< without the picture of the report
};

/// Simulates one frame and writes it with its truth. Noise depends on its number.
/// \throws InvalidInput if the camera sees nothing of the mesh.
SimulatedShot do_shot(const SimulateCall& call, const SimulateSetup& setup, const fs::path& output,
                      std::size_t number);

}  // namespace palpate::apps
