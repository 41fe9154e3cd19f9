// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "palpate/geometry/camera.h"
#include "palpate/sensing/live_camera.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// The camera of a call, and its settings.
struct LiveCameraCall {
  std::string name;
  std::vector<int> size;  ///< width, height [px]; empty: as the camera is set
  sensing::CameraSettings settings;
  double patience = 5;  ///< [s]
};

/// Adds CAMERA and the options of its settings.
void add_live_camera_options(CLI::App& command, LiveCameraCall& call);
/// Adds the options of its settings alone, and returns them.
std::vector<CLI::Option*> add_camera_settings(CLI::App& command, LiveCameraCall& call);

/// The kinds of names of live cameras, for help.
inline constexpr const char* kLiveCameras =
    "aravis:NAME (GenICam), v4l2:NUMBER, or simulated:PATH, which plays a folder of images or a "
    "video in a loop; palpate capture list lists the available cameras";

/// Opens the camera, and prints its warnings.
/// \throws InvalidInput or DeviceError.
[[nodiscard]] std::unique_ptr<sensing::LiveCamera> open_live_camera(const LiveCameraCall& call);

/// \param rig names the file of the rig whose camera this is, for messages.
/// \throws InvalidInput if the frames do not have the size of the rig's camera.
void check_sends_frames_of(const geometry::Camera& rig_camera, const fs::path& rig,
                           const sensing::CameraState& state);

/// The settings of the camera, for records and reports.
[[nodiscard]] Json camera_figures(const sensing::CameraState& state);

/// Options that `palpate decode` needs for its frames: " --bayer rggb --bits 12"; mostly none.
[[nodiscard]] std::string decode_options_of(const sensing::CameraState& state);

/// The name of a mosaic, as --bayer takes it.
[[nodiscard]] std::string bayer_name(sensing::BayerPattern pattern);

}  // namespace palpate::apps
