// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace palpate::sensing {

/// Decodes the bytes of a PNG file with libpng, without OpenCV's codecs, which take longer to load
/// than most images to read: 1 or 3 channels (BGR) of 8 or 16 bit. Colours of a palette become BGR,
/// 1 to 4 bit become 8, alpha is dropped.
/// \throws InvalidInput saying what is truncated or damaged, or larger than memory allows.
[[nodiscard]] cv::Mat decode_png(const std::string& bytes);

/// The bytes of a PNG file with an image of 1 or 3 channels (BGR) of 8 or 16 bit that is not empty,
/// which is not checked.
[[nodiscard]] std::string encode_png(const cv::Mat& image);

}  // namespace palpate::sensing
