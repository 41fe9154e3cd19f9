// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Images of single scenes, under one projected image after the other.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/sensing/frame.h"
#include "seeing/capture.h"
#include "seeing/capture_stage.h"
#include "shared/call_checks.h"

namespace palpate::apps {
namespace {

constexpr const char* kDrawn = "palpate pattern -o pattern/";

struct StillsCall {
  StageCall stage;
  std::vector<double> exposures;  ///< [us], of `multishot`
  int planes = 5;
};

struct NamedStill {
  fs::path name;  ///< relative to the output
  cv::Mat image;
};

/// PNG, because every calibration reads it.
fs::path still_name(const fs::path& shown) { return shown.stem().string() + ".png"; }

/// Writes all images at once, into a new or an empty folder.
void write_stills(const Settings& settings, const StageCall& call, const Stage& stage,
                  const sensing::CameraState& camera, const std::vector<NamedStill>& stills,
                  const std::string& next) {
  write_folder(call.output, {}, [&](const fs::path& folder) {
    for (const NamedStill& still : stills) sensing::write_png(folder / still.name, still.image);
  });
  stage.warn_of_clipping();
  print(settings,
        {{"folder", call.output.string()},
         {"camera", camera_figures(camera)},
         {"images", stills.size()},
         {"clipped", stage.most_clipped()}},
        fmt::format("{} images in {}; at most {:.2g} % of their values are at full scale\nNext: {}",
                    stills.size(), call.output.string(), 100 * stage.most_clipped(), next));
}

/// \throws Error if the user does not want to go on.
void wait_until_placed(const std::string& words) {
  if (!operator_is_ready(words)) throw Error("ended; nothing was written");
}

void take_training(const Settings& settings, const StillsCall& call) {
  const StageCall& setup = call.stage;
  const std::vector<fs::path> shown =
      images_to_show(setup.show, {"grey_", "projector_off"}, {"_flat", "_sin"}, kDrawn);
  check_replaceable(setup.output, {});
  Stage stage(setup);
  wait_until_placed(
      "Place a white or grey surface where the object will be, and leave it there. The exposure "
      "must be that of the later frames.");
  std::vector<NamedStill> stills;
  for (const fs::path& image : shown) stills.push_back({still_name(image), stage.take(image)});
  const std::string folder = setup.output.string();
  write_stills(settings, setup, stage, stage.camera().state(), stills,
               fmt::format("palpate calibrate response {0} -o response.yaml\n"
                           "      palpate calibrate colors {0} -o colors.yaml",
                           folder));
}

void take_multishot(const Settings& settings, const StillsCall& call) {
  const StageCall& setup = call.stage;
  const std::vector<fs::path> shown =
      images_to_show(setup.show, {"shot_"}, {}, "palpate pattern --multishot 8 -o multishot/");
  check_replaceable(setup.output, {});
  Stage stage(setup);
  wait_until_placed("Place the object; it must not move until all images are taken.");
  std::vector<NamedStill> stills;
  std::string folders;
  const std::size_t exposures = std::max<std::size_t>(call.exposures.size(), 1);
  for (std::size_t i = 0; i < exposures; ++i) {
    if (!call.exposures.empty()) stage.camera().set_exposure(call.exposures[i]);
    const fs::path folder = exposures > 1 ? fmt::format("exposure_{}", i + 1) : "";
    folders += " " + (setup.output / folder).string();
    for (const fs::path& image : shown)
      stills.push_back({folder / still_name(image), stage.take(image)});
  }
  write_stills(
      settings, setup, stage, stage.camera().state(), stills,
      fmt::format("palpate decode{} --multishot{} --rig {} --pattern {} -o still/", folders,
                  exposures > 1 ? fmt::format(" --exposures {}", exposures) : "",
                  (setup.show / "rig.yaml").string(), (setup.show / "pattern.yaml").string()));
}

void take_planes(const Settings& settings, const StillsCall& call) {
  const StageCall& setup = call.stage;
  const std::vector<fs::path> shown = images_to_show(setup.show, {"white_sin"}, {}, kDrawn);
  check_replaceable(setup.output, {});
  Stage stage(setup);
  std::vector<NamedStill> stills;
  for (int i = 0; i < call.planes; ++i) {
    wait_until_placed(fmt::format(
        "Plane {} of {}: place a flat white board at another distance than before, from the "
        "nearest to the farthest that you use, and fill the image.",
        i + 1, call.planes));
    stills.push_back({fmt::format("plane_{:02}.png", i), stage.take(shown.front())});
  }
  write_stills(settings, setup, stage, stage.camera().state(), stills,
               fmt::format("palpate calibrate chromatic {} --rig rig.yaml --pattern {} -o "
                           "rig_chromatic.yaml",
                           setup.output.string(), (setup.show / "pattern.yaml").string()));
}

}  // namespace

void add_capture_stills(CLI::App& capture, const Settings& settings) {
  const auto add = [&](const char* name, const char* does, const char* images,
                       const std::string& footer, auto take) {
    auto call = std::make_shared<StillsCall>();
    CLI::App* command = capture.add_subcommand(name, does);
    add_stage_options(*command, call->stage, images);
    command->footer(footer);
    command->callback([call, &settings, take] { take(settings, *call); });
    return std::pair(command, call);
  };
  add("training", "Take the images for calibrate colors, response and crosstalk",
      "R_flat.png, R_sin.png, ..., grey_000.png, ... (palpate pattern)",
      "Shows the images one after the other and takes one of each, under the same name.\n"
      "Example:\n  palpate capture training aravis:Basler-21857625 --exposure 4000 --show pattern/ "
      "-o training/",
      take_training);
  const auto multishot = add(
      "multishot", "Take the images of a still scene for decode --multishot",
      "shot_00.png, ... (palpate pattern --multishot)",
      "With several --exposures, all images are taken with each of them, into folders "
      "exposure_1, ...\n"
      "Example:\n  palpate capture multishot aravis:Basler-21857625 --exposures 1000 4000 16000 "
      "--show multishot/ -o captures/",
      take_multishot);
  add_number(*multishot.first, "--exposures", multishot.second->exposures, above(0).finite(),
             "Exposure times [us], for scenes with bright and dark areas")
      ->excludes("--exposure");
  const auto planes =
      add("planes", "Take the images of planes for calibrate chromatic",
          "white_sin.png (palpate pattern)",
          "Example:\n  palpate capture planes aravis:Basler-21857625 --show pattern/ -o white/",
          take_planes);
  add_number(*planes.first, "--count", planes.second->planes, at_least(1), "Number of planes")
      ->capture_default_str();
}

}  // namespace palpate::apps
