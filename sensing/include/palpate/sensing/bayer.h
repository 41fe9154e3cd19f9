// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <string_view>

namespace palpate::sensing {

/// Colour filter array of a single-chip camera: the colours of the first two pixels of the first
/// row, then of the second row; they repeat every two pixels. (OpenCV names its conversions after
/// the pixels that begin at (1, 1): rggb is its BayerBG.)
enum class BayerPattern { rggb, bggr, grbg, gbrg };

/// Converts a name such as "rggb".
/// \throws InvalidInput if the name is unknown.
[[nodiscard]] BayerPattern bayer_pattern(std::string_view name);

/// Interpolates a mosaic (8 or 16 bit, one channel) bilinearly to BGR of the same size and depth.
/// A missing colour is the mean of the two or four nearest pixels that have it; border pixels copy
/// their inner neighbours. Unlike edge-aware methods this is one linear filter of even phase: it
/// weakens the sinusoid in red and blue, but does not shift it.
/// \throws InvalidInput unless `mosaic` has this type and at least 3 x 3 px.
[[nodiscard]] cv::Mat demosaic(const cv::Mat& mosaic, BayerPattern pattern);

}  // namespace palpate::sensing
