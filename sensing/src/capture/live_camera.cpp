// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/live_camera.h"

#include "capture/aravis_camera.h"
#include "capture/simulated_camera.h"
#include "capture/v4l2_camera.h"
#include "palpate/core/error.h"
#include "palpate/core/module.h"

namespace palpate::sensing {

const AravisCameras& aravis_cameras() {
  static const void* const cameras = module_symbol("aravis_camera");
  return *static_cast<const AravisCameras*>(cameras);
}

void visit(CameraSettings& settings, FieldVisitor& visitor) {
  visitor.begin("CameraSettings");
  visitor.real({"rate", "Frames per second", "frames/s"}, settings.rate, above(0).finite());
  visitor.real(
      {.name = "exposure_us", .description = "Exposure time", .unit = "us", .option = "exposure"},
      settings.exposure_us, above(0).finite());
  visitor.real({"gain", "Gain, in the camera's unit, which is usually dB"}, settings.gain,
               finite());
}

std::unique_ptr<LiveCamera> open_camera(const std::string& name, const CameraSettings& settings) {
  static_cast<void>(in_range(settings));
  const std::size_t colon = name.find(':');
  const std::string kind = name.substr(0, colon);
  const std::string rest = colon == std::string::npos ? std::string() : name.substr(colon + 1);
  if (colon != std::string::npos && !rest.empty()) {
    if (kind == "aravis") return aravis_cameras().open(rest, settings);
    if (kind == "v4l2") return open_v4l2_camera(rest, settings);
    if (kind == "simulated") return open_simulated_camera(rest, settings);
  }
  throw InvalidInput(name +
                     ": is no camera; it must be aravis:NAME, v4l2:NUMBER or simulated:PATH. "
                     "palpate capture list shows which are connected.");
}

CameraList list_cameras() {
  CameraList list;
  try {
    list.cameras = aravis_cameras().list();
  } catch (const Error& error) {
    list.problems.emplace_back(error.what());
  }
  const std::vector<CameraEntry> devices = list_v4l2_cameras();
  list.cameras.insert(list.cameras.end(), devices.begin(), devices.end());
  return list;
}

}  // namespace palpate::sensing
