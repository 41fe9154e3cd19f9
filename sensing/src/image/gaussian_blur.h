// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace palpate::sensing {

/// Assumed values of the pixels outside an image.
enum class Border { black, replicated };

/// Convolves an image of float channels with a Gaussian of standard deviation `sigma` px; 0 leaves
/// the image unchanged. Replaces OpenCV's filter, whose last digit depends on the processor.
[[nodiscard]] cv::Mat gaussian_blur(const cv::Mat& image, double sigma, Border border);

}  // namespace palpate::sensing
