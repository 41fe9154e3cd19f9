// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "palpate/sensing/live_camera.h"
#include "seeing/live_camera_call.h"
#include "seeing/projector_window.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// Options of all commands that show images on a projector and take one image of each.
struct StageCall {
  LiveCameraCall camera;
  fs::path show;  ///< folder of the images to show
  fs::path output;
  std::string projector;
  bool by_hand = false;    ///< the user shows the images
  double settle_ms = 200;  ///< [ms] until an image is on the screen
};

/// Adds the options of a call. \param images that --show must contain, for its help.
void add_stage_options(CLI::App& command, StageCall& call, const std::string& images);

/// Tells the person at the rig what to do, and waits for Enter.
/// \return false if the answer was q, or standard input has ended.
[[nodiscard]] bool operator_is_ready(const std::string& words);

/// A camera and a projector that work together.
class Stage {
 public:
  /// \throws InvalidInput or DeviceError.
  explicit Stage(const StageCall& call);

  /// Shows an image and takes one of it, with the object at rest. The result is in colour if the
  /// camera has a mosaic, and uses all 16 bits if it has more than 8.
  /// \throws InvalidInput if the image does not fit the projector; DeviceError.
  [[nodiscard]] cv::Mat take(const fs::path& image);

  [[nodiscard]] sensing::LiveCamera& camera() { return *camera_; }
  /// Largest share of pixels at full scale in an image that was taken.
  [[nodiscard]] double most_clipped() const { return most_clipped_; }
  /// Warns if images are too bright.
  void warn_of_clipping() const;

 private:
  StageCall call_;
  std::unique_ptr<sensing::LiveCamera> camera_;
  std::optional<ProjectorWindow> projector_;
  double most_clipped_ = 0;
  std::string brightest_;
};

/// The images of a folder whose names begin or end like one of these, by name.
/// \throws InvalidInput if there are none; `remedy` explains how to make them.
[[nodiscard]] std::vector<fs::path> images_to_show(const fs::path& folder,
                                                   const std::vector<std::string>& starts,
                                                   const std::vector<std::string>& ends,
                                                   const std::string& remedy);

}  // namespace palpate::apps
