// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "palpate/sensing/live_camera.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// The camera of a call, and how it is to be set.
struct LiveCameraCall {
  std::string name;
  std::vector<int> size;  ///< width, height [px]; empty: as the camera is set
  sensing::CameraSettings settings;
  double patience = 5;  ///< [s]
};

/// Adds CAMERA and the options of its settings.
void add_live_camera_options(CLI::App& command, LiveCameraCall& call);

/// Opens the camera, and prints what it warns of.
/// \throws InvalidInput or DeviceError.
[[nodiscard]] std::unique_ptr<sensing::LiveCamera> open_live_camera(const LiveCameraCall& call);

/// How the camera is set, for records and reports.
[[nodiscard]] Json camera_figures(const sensing::CameraState& state);

/// What `palpate decode` has to know of its frames: " --bayer rggb --bits 12"; mostly nothing.
[[nodiscard]] std::string decode_options_of(const sensing::CameraState& state);

/// The name of a mosaic, as --bayer takes it.
[[nodiscard]] std::string bayer_name(sensing::BayerPattern pattern);

}  // namespace palpate::apps
