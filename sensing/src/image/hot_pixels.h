// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace palpate::sensing {

/// Replaces single pixels that stand out from the eight nearest of their colour, such as hot and
/// dead pixels of the sensor, by the mean of two of these. Interpolation would spread them over
/// nine pixels, and demodulation over its window.
/// \param mosaic Bayer mosaic of 8 or 16 bit, at least 3 x 3 px; other images are returned as they
/// are.
[[nodiscard]] cv::Mat without_hot_pixels(const cv::Mat& mosaic);

}  // namespace palpate::sensing
