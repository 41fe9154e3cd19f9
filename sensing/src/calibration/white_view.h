// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "image/image_plane.h"
#include "palpate/sensing/chromatic_calibration.h"
#include "phase/demodulation.h"
#include "setup/carrier.h"
#include "setup/triangulation.h"

namespace palpate::sensing {

/// A block of pixels about as large as the demodulation window: one phase measurement that is
/// nearly independent of its neighbours.
struct PhaseCell {
  long row = 0;  ///< of the first pixel in the working image
  long column = 0;
  Eigen::Vector2d center = Eigen::Vector2d::Zero();  ///< mean (row, column) of its reliable pixels
  Eigen::Vector2d gradient =
      Eigen::Vector2d::Zero();  ///< of green's phase along (row, column) [rad/px], with the carrier
  double phase = 0;  ///< green's at `center` [rad], with the carrier, unwrapped in the region
  int region = 0;
  double pixel = 0;  ///< projector pixel along the axis, once the period is known
  double depth = 0;  ///< depth, once the period is known
};

/// The camera pixel of the centre of a cell [px].
[[nodiscard]] Eigen::Vector2d camera_pixel(const PhaseCell& cell, const Carrier& carrier);

/// The phases of all channels of one white image.
struct WhiteView {
  Demodulated green;
  std::array<Demodulated, 2> others;  ///< red, blue
  Mask reliable;
  std::vector<PhaseCell> cells;  ///< cells of which at least three quarters is reliable
  int cell_size = 0;             ///< [px]
  int regions = 0;
};

/// \param mixing of the colours, see `Rig::color_mixing`.
[[nodiscard]] WhiteView measure_white_view(const cv::Mat& image, const Carrier& carrier,
                                           const Eigen::Matrix3d& mixing, const Pattern& pattern,
                                           const ChromaticCalibrationOptions& options);

}  // namespace palpate::sensing
