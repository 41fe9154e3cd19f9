// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <string_view>

namespace palpate::sensing {

/// Colours before the pixels of a single-chip camera: those of the first two pixels of the first
/// row, then of the second; they repeat every two pixels both ways. (OpenCV names its conversions
/// by the pixels that begin at (1, 1): rggb is its BayerBG.)
enum class BayerPattern { rggb, bggr, grbg, gbrg };

/// \throws InvalidInput for another name.
[[nodiscard]] BayerPattern bayer_pattern(std::string_view name);

/// `mosaic` of 8 or 16 bit, one channel, becomes BGR of the same size and depth: what a pixel does
/// not see is the mean of its two or four nearest neighbours that do (bilinear; at the border, of
/// the pixel next to it). Of OpenCV's ways this one does not look at edges, so that it acts on the
/// sinusoid as one linear filter of even phase: it weakens red and blue, but shifts nothing.
/// \throws InvalidInput unless `mosaic` is of that type and at least 3 x 3 px.
[[nodiscard]] cv::Mat demosaic(const cv::Mat& mosaic, BayerPattern pattern);

}  // namespace palpate::sensing
