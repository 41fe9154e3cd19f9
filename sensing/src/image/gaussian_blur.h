// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace palpate::sensing {

/// What lies beyond the border of an image.
enum class Border { black, replicated };

/// Convolves an image of float channels with a Gaussian bell of standard deviation `sigma` px; 0
/// changes nothing. Not OpenCV's, whose last digit depends on the processor.
[[nodiscard]] cv::Mat gaussian_blur(const cv::Mat& image, double sigma, Border border);

}  // namespace palpate::sensing
