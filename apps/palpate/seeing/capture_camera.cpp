// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/capture_camera.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>

#include "shared/call_checks.h"
#include "shared/command_line.h"

namespace palpate::apps {

void add_live_camera_options(CLI::App& command, LiveCameraCall& call) {
  command
      .add_option("CAMERA", call.name,
                  "aravis:NAME (GenICam), v4l2:NUMBER, or simulated:PATH, which plays a folder of "
                  "images or a video in a loop; palpate capture list lists the available cameras")
      ->required();
  add_number(command, "--size", call.size, at_least(2), "Width and height of the frames [px]")
      ->expected(2);
  add_number(command, "--rate", call.settings.rate, above(0).finite(), "Frames per second");
  add_number(command, "--exposure", call.settings.exposure_us, above(0).finite(),
             "Exposure time [us]");
  add_number(command, "--gain", call.settings.gain, finite(),
             "Gain, in the camera's unit (usually dB)");
  command.add_option("--pixel-format", call.settings.pixel_format,
                     "As GenICam names it, such as Mono8, BayerRG8, BayerRG12, RGB8");
  add_number(command, "--patience", call.patience, above(0).finite(),
             "Time without a frame after which the camera counts as dead [s]; longer than "
             "the interval of its frames")
      ->capture_default_str();
}

std::unique_ptr<sensing::LiveCamera> open_live_camera(const LiveCameraCall& call) {
  sensing::CameraSettings settings = call.settings;
  if (!call.size.empty()) settings.size = {call.size[0], call.size[1]};
  std::unique_ptr<sensing::LiveCamera> camera = sensing::open_camera(call.name, settings);
  for (const std::string& warning : camera->state().warnings) spdlog::warn("{}", warning);
  return camera;
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
