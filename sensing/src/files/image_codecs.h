// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>

namespace palpate::sensing {

/// Functions of the module `image_codecs`: OpenCV's reading of images, which needs 140 shared
/// libraries.
struct ImageCodecs {
  /// As cv::imdecode; empty if the bytes are damaged. Throws cv::Exception.
  cv::Mat (*decode)(const std::string& bytes, int flags);
};

/// Decodes the content of an image file by OpenCV, with the flags of cv::imread.
/// \throws FileError if it is damaged or of an unknown format.
[[nodiscard]] cv::Mat decode_image(const std::filesystem::path& path, const std::string& bytes,
                                   int flags);

}  // namespace palpate::sensing

extern "C" const palpate::sensing::ImageCodecs palpate_image_codecs;
