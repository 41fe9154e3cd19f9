// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/live_camera_call.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>

#include "palpate/core/error.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"

namespace palpate::apps {

void add_live_camera_options(CLI::App& command, LiveCameraCall& call) {
  add_required(command, "CAMERA", call.name, kLiveCameras);
  add_camera_settings(command, call);
}

std::vector<CLI::Option*> add_camera_settings(CLI::App& command, LiveCameraCall& call) {
  std::vector<CLI::Option*> options = add_fields(command, fields_of(call.settings));
  options.push_back(
      add_number(command, "--size", call.size, at_least(2), "Width and height of the frames [px]")
          ->expected(2));
  options.push_back(
      command.add_option("--pixel-format", call.settings.pixel_format,
                         "As GenICam names it, such as Mono8, BayerRG8, BayerRG12, RGB8"));
  options.push_back(add_number(command, "--patience", call.patience, above(0).finite(),
                               "Time without a frame after which the camera counts as dead [s]; "
                               "longer than the interval of its frames")
                        ->capture_default_str());
  return options;
}

std::unique_ptr<sensing::LiveCamera> open_live_camera(const LiveCameraCall& call) {
  sensing::CameraSettings settings = call.settings;
  if (!call.size.empty()) settings.size = {call.size[0], call.size[1]};
  std::unique_ptr<sensing::LiveCamera> camera = sensing::open_camera(call.name, settings);
  for (const std::string& warning : camera->state().warnings) spdlog::warn("{}", warning);
  return camera;
}

void check_sends_frames_of(const geometry::Camera& rig_camera, const fs::path& rig,
                           const sensing::CameraState& state) {
  if (rig_camera.width == state.size.width && rig_camera.height == state.size.height) return;
  throw InvalidInput(fmt::format(
      "{}: the rig's camera has {} x {} px; {} sends {} x {} px. Set --size, or calibrate the rig "
      "with the size at which you record.",
      rig.string(), rig_camera.width, rig_camera.height, state.name, state.size.width,
      state.size.height));
}

std::string bayer_name(sensing::BayerPattern pattern) {
  for (const char* name : {"rggb", "bggr", "grbg", "gbrg"}) {
    if (sensing::bayer_pattern(name) == pattern) return name;
  }
  return {};
}

Json camera_figures(const sensing::CameraState& state) {
  return {{"name", state.name},
          {"camera_size", {state.size.width, state.size.height}},
          {"rate", number_or_null(state.rate > 0 ? std::optional(state.rate) : std::nullopt)},
          {"exposure_us", number_or_null(state.exposure_us)},
          {"gain", number_or_null(state.gain)},
          {"pixel_format", state.pixel_format},
          {"bayer", state.bayer ? bayer_name(*state.bayer) : ""},
          {"bits", state.bits},
          {"counts_frames", state.counts_frames}};
}

std::string decode_options_of(const sensing::CameraState& state) {
  std::string options;
  if (state.bayer) options += " --bayer " + bayer_name(*state.bayer);
  if (state.bits > 8) options += fmt::format(" --bits {}", state.bits);
  return options;
}

}  // namespace palpate::apps
