// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/capture.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>

#include "palpate/sensing/live_camera.h"

namespace palpate::apps {

void add_capture_list(CLI::App& capture, const Settings& settings) {
  CLI::App* command = capture.add_subcommand("list", "List the cameras that are connected");
  command->footer(
      "GenICam cameras (GigE Vision, USB3 Vision) are found by Aravis, others by V4L2.\n"
      "Example:\n  palpate capture list");
  command->callback([&settings] {
    const sensing::CameraList list = sensing::list_cameras();
    for (const std::string& problem : list.problems) spdlog::warn("{}", problem);
    Json cameras = Json::array();
    std::string prose;
    for (const sensing::CameraEntry& camera : list.cameras) {
      cameras.push_back({{"name", camera.name}, {"model", camera.model}});
      prose += fmt::format("{}: {}\n", camera.name, camera.model);
    }
    prose += list.cameras.empty()
                 ? "No camera was found. Is it plugged in, and in the same network? Without one, "
                   "simulated:FOLDER plays images"
                 : fmt::format("{} found", list.cameras.size());
    print(settings, {{"cameras", cameras}}, prose);
  });
}

void add_capture(CLI::App& app, const Settings& settings) {
  CLI::App* capture =
      app.add_subcommand("capture", "Record with a camera, and show images on a projector");
  capture->require_subcommand(1);
  add_capture_list(*capture, settings);
  add_capture_sequence(*capture, settings);
  add_capture_calibration(*capture, settings);
  add_capture_stills(*capture, settings);
}

}  // namespace palpate::apps
