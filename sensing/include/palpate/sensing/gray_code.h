// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "palpate/sensing/image_size.h"

namespace palpate::sensing {

/// How many images `draw_gray_code` makes for a panel.
/// \throws InvalidInput unless width and height lie between 2 and 2^15 px.
[[nodiscard]] int gray_code_length(const ImageSize& panel);

/// The sequence that tells every projector pixel from the others (reflected binary code; Inokuchi,
/// Sato and Matsuda 1984): for the columns, then for the rows, the bits of the coordinate from the
/// highest to the lowest, each followed by its inverse; then white, then black. This is the order
/// of OpenCV's structured_light module. Images of 8 bit, 0 or 255, height x width.
/// \throws InvalidInput as above.
[[nodiscard]] std::vector<cv::Mat> draw_gray_code(const ImageSize& panel);

struct GrayCodeOptions {
  /// A pixel is decoded iff white - black >= min_contrast of full scale; in (0, 1).
  double min_contrast = 0.03;
};

/// Which projector pixel lights each camera pixel.
///
/// `images`: what the camera saw of `draw_gray_code`, in its order; 8 or 16 bit, 1 channel. The
/// result has one pair (x, y) a camera pixel, in whole projector pixels; NaN where the pixel is too
/// dark or the code names a place beside the panel. Each bit is the sign of image - inverse, so
/// that neither the surface's colour nor steady light matters. A bit that is read wrong at its own
/// edge moves the result by one pixel only, because neighbouring codes differ in one bit. \throws
/// InvalidInput on a wrong number, size or type of the images, or an option outside its range.
[[nodiscard]] cv::Mat_<cv::Vec2f> decode_gray_code(const std::vector<cv::Mat>& images,
                                                   const ImageSize& panel,
                                                   const GrayCodeOptions& options = {});

}  // namespace palpate::sensing
