// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::sensing {

/// Images of one still scene, linear in the light, 8 or 16 bit BGR, of one size: the projector off
/// (or black), and evenly red, green and blue.
struct CrosstalkImages {
  cv::Mat off;
  cv::Mat red;
  cv::Mat green;
  cv::Mat blue;
};

struct CrosstalkOptions {
  /// A pixel is used if each colour adds >= min_signal of full scale to its own channel;
  /// in (0, 1).
  double min_signal = 0.05;
};

struct CrosstalkCalibration {
  /// Light that the camera's red, green and blue channel (rows) receive from the projector's red,
  /// green and blue (columns), relative to the diagonal: `Rig::color_mixing`.
  Eigen::Matrix3d mixing = Eigen::Matrix3d::Identity();
  /// Standard deviation of each entry, from its scatter between 16 parts of the image.
  Eigen::Matrix3d deviation = Eigen::Matrix3d::Zero();
  long pixels = 0;  ///< number of pixels used
};

/// Measures how the camera's colour filters mix the projector's colours. A surface reflects each of
/// the projector's bands by a factor that all channels share, so its colour does not matter as long
/// as it reflects all three.
///
///     mixing(i, j) = sum (channel i under colour j - off) / sum (channel j under colour j - off)
///
/// over the pixels that are lit and not at full scale in any image.
/// \throws InvalidInput if an image has another type or size, the option is outside its range,
/// fewer than 1000 pixels can be used, or the colours cannot be separated (an entry off the
/// diagonal is below -0.1 or above 0.9, or the matrix is nearly singular).
[[nodiscard]] CrosstalkCalibration calibrate_crosstalk(const CrosstalkImages& images,
                                                       const CrosstalkOptions& options = {});

}  // namespace palpate::sensing
