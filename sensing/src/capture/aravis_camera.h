// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "palpate/sensing/live_camera.h"

namespace palpate::sensing {

/// Functions of the module `aravis_camera`: cameras of GenICam by Aravis, which needs GLib.
struct AravisCameras {
  std::unique_ptr<LiveCamera> (*open)(const std::string& name, const CameraSettings& settings);
  std::vector<CameraEntry> (*list)();
};

/// \throws Error if the module or Aravis is not installed.
[[nodiscard]] const AravisCameras& aravis_cameras();

}  // namespace palpate::sensing

extern "C" const palpate::sensing::AravisCameras palpate_aravis_camera;
