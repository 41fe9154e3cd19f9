// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/capture_stage.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <thread>

#include "palpate/core/error.h"
#include "palpate/sensing/decodable.h"
#include "palpate/sensing/frame_source.h"
#include "palpate/sensing/recording.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"

namespace palpate::apps {
namespace {

/// Share of pixels at full scale above which an exposure is too long.
constexpr double kMostClipped = 0.01;

double clipped_share(const cv::Mat& image, int bits) {
  const double full = (1 << bits) - 1;
  const cv::Mat values = image.reshape(1);
  return static_cast<double>(cv::countNonZero(values >= full)) /
         static_cast<double>(values.total());
}

}  // namespace

void add_stage_options(CLI::App& command, StageCall& call, const std::string& images) {
  add_live_camera_options(command, call.camera);
  add_required(command, "--show", call.show, "Folder of the images to show: " + images);
  add_required(command, "-o,--output", call.output, "Folder for the images that are taken");
  CLI::Option* projector =
      command.add_option("--projector", call.projector,
                         "Monitor that is the projector, by number or name (palpate-project "
                         "--list); default: the last one");
  command
      .add_flag("--by-hand", call.by_hand,
                "You show each image yourself, with another program or a slide, and press Enter")
      ->excludes(projector);
  add_number(command, "--settle", call.settle_ms, at_least(0).finite(),
             "Time until an image that was handed to the projector is on the object [ms]")
      ->capture_default_str();
}

bool operator_is_ready(const std::string& words) {
  std::fputs((words + " [Enter; q ends] ").c_str(), stderr);
  std::string line;
  return std::getline(std::cin, line) && line != "q";
}

Stage::Stage(const StageCall& call) : call_(call), camera_(open_live_camera(call.camera)) {
  if (!call_.by_hand) projector_.emplace(call_.projector);
  camera_->start();
}

cv::Mat Stage::take(const fs::path& image) {
  if (projector_) {
    projector_->show(image);
    std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(call_.settle_ms));
  } else if (!operator_is_ready("Show " + image.string() + " on the projector")) {
    throw Error("ended at " + image.string() +
                "; the images of this series are not complete and were not kept");
  }
  const sensing::CameraFrame frame = sensing::take_fresh(*camera_, call_.camera.patience);
  const sensing::CameraState& state = camera_->state();
  const double clipped = clipped_share(frame.image, state.bits);
  if (clipped > most_clipped_) {
    most_clipped_ = clipped;
    brightest_ = image.filename().string();
  }
  return sensing::decodable(frame.image, state.bayer, state.bits);
}

void Stage::warn_of_clipping() const {
  if (most_clipped_ <= kMostClipped) return;
  spdlog::warn(
      "{:.0f} % of the values under {} are at full scale: their true values are unknown. Take "
      "the images again with a shorter --exposure",
      100 * most_clipped_, brightest_);
}

std::vector<fs::path> images_to_show(const fs::path& folder, const std::vector<std::string>& starts,
                                     const std::vector<std::string>& ends,
                                     const std::string& remedy) {
  std::vector<fs::path> images = sensing::list_images(folder);
  std::erase_if(images, [&](const fs::path& image) {
    const std::string stem = image.stem().string();
    return std::ranges::none_of(starts, [&](const auto& s) { return stem.starts_with(s); }) &&
           std::ranges::none_of(ends, [&](const auto& e) { return stem.ends_with(e); });
  });
  if (images.empty()) {
    throw InvalidInput(folder.string() + ": holds none of the images to show; make them with " +
                       remedy + ".");
  }
  return images;
}

}  // namespace palpate::apps
