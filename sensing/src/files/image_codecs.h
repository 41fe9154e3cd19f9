// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace palpate::sensing {

/// What the module `image_codecs` does: OpenCV's reading and writing of images, which needs 140
/// shared libraries. The functions throw cv::Exception.
struct ImageCodecs {
  /// As cv::imdecode; empty if the bytes are damaged.
  cv::Mat (*decode)(const std::string& bytes, int flags);
  /// As cv::imencode; the ending, such as ".png", chooses the format.
  std::vector<unsigned char> (*encode)(const std::string& ending, const cv::Mat& image);
};

/// Decodes the content of an image file by OpenCV, with the flags of cv::imread.
/// \throws FileError if it is damaged or of an unknown format.
[[nodiscard]] cv::Mat decode_image(const std::filesystem::path& path, const std::string& bytes,
                                   int flags);

/// Writes an image in the format that `ending` names, such as ".png".
/// \throws OutputError if that cannot be done.
void write_image(const std::filesystem::path& path, const std::string& ending,
                 const cv::Mat& image);

}  // namespace palpate::sensing

extern "C" const palpate::sensing::ImageCodecs palpate_image_codecs;
