// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "palpate/sensing/image_size.h"

namespace palpate::sensing {

/// The reflected binary code of a number, and the number of a code.
[[nodiscard]] unsigned gray_code_of(unsigned number);
[[nodiscard]] unsigned number_of_gray_code(unsigned code);

/// Number of images that `draw_gray_code` makes for a panel.
/// \throws InvalidInput unless width and height lie between 2 and 2^15 px.
[[nodiscard]] int gray_code_length(const ImageSize& panel);

/// Draws the Gray code sequence that identifies every projector pixel (reflected binary code;
/// Inokuchi, Sato and Matsuda 1984).
///
/// The images show the bits of the column, then of the row, from the highest to the lowest, each
/// followed by its inverse; then white, then black. This is the order of OpenCV's structured_light
/// module. Images have 8 bit, the values 0 and 255, and the size height x width.
/// \throws InvalidInput as above.
[[nodiscard]] std::vector<cv::Mat> draw_gray_code(const ImageSize& panel);

struct GrayCodeOptions {
  /// A pixel is decoded if white - black >= min_contrast of full scale; in (0, 1).
  double min_contrast = 0.03;
};

/// Finds the projector pixel that lights each camera pixel.
///
/// Each bit is the sign of image - inverse, so that neither surface colour nor steady light
/// matters. Neighbouring codes differ in one bit, so a bit that is misread at its own edge moves
/// the result by only one pixel.
/// \param images camera images of `draw_gray_code` in its order; 8 or 16 bit, 1 channel.
/// \return a pair (x, y) per camera pixel, in whole projector pixels; NaN where the pixel is too
/// dark or the code lies outside the panel.
/// \throws InvalidInput if the number, size or type of the images is wrong, an option is outside its
/// range, or so many codes lie outside that the panel must be another.
[[nodiscard]] cv::Mat_<cv::Vec2f> decode_gray_code(const std::vector<cv::Mat>& images,
                                                   const ImageSize& panel,
                                                   const GrayCodeOptions& options = {});

}  // namespace palpate::sensing
