// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace palpate::sensing {

/// Describes the damage in the bytes of a PNG file, or returns an empty text: checks signature,
/// chunk lengths, checksums and the closing chunk. Decoders silently fill the missing part of a
/// truncated file with black.
[[nodiscard]] std::string find_png_damage(const std::string& bytes);

/// Decodes the bytes of a PNG file in which `find_png_damage` finds nothing: 1 or 3 channels (BGR)
/// of 8 or 16 bit; alpha is dropped. Returns an empty image for types that a camera does not write
/// (palette, interlaced, below 8 bit, grey with alpha), which are left to OpenCV. Two to three
/// times as fast as OpenCV, which uses libpng and zlib, and without messages on the terminal.
/// \throws InvalidInput saying what is damaged.
[[nodiscard]] cv::Mat decode_png(const std::string& bytes);

/// The bytes of a PNG file with an image of 1 or 3 channels (BGR) of 8 or 16 bit that is not empty,
/// which is not checked. OpenCV's codecs, which take longer to load than most images to write, are
/// not needed.
[[nodiscard]] std::string encode_png(const cv::Mat& image);

}  // namespace palpate::sensing
