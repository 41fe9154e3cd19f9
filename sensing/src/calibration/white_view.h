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

/// A block of pixels about as large as the demodulation window: one phase measurement that hardly
/// depends on its neighbours'.
struct PhaseCell {
  long row = 0;  ///< of its first pixel in the working image
  long column = 0;
  Eigen::Vector2d center = Eigen::Vector2d::Zero();  ///< mean (row, column) of its reliable pixels
  Eigen::Vector2d gradient =
      Eigen::Vector2d::Zero();  ///< of green's phase by (row, column) [rad/px], carrier included
  double phase = 0;  ///< green's at `center` [rad], carrier included, unwrapped in the region
  int region = 0;
  double pixel = 0;  ///< the projector's along the axis there, once the period is known
  double depth = 0;  ///< and the depth
};

/// The phases of all channels of one white image.
struct WhiteView {
  Demodulated green;
  std::array<Demodulated, 2> others;  ///< red, blue
  Mask reliable;
  std::vector<PhaseCell> cells;  ///< at least three quarters of their pixels being reliable
  int cell_size = 0;             ///< [px]
  int regions = 0;
};

[[nodiscard]] WhiteView measure_white_view(const cv::Mat& image, const Carrier& carrier,
                                           const Pattern& pattern,
                                           const ChromaticCalibrationOptions& options);

}  // namespace palpate::sensing
