// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace palpate::sensing {

/// Reads a camera frame: PNG or TIFF; 8 or 16 bit, 1 channel or 3 (BGR).
/// Values as they stand in the file; an alpha channel is dropped.
/// \throws FileError if the file is missing, empty, truncated, damaged or of another type.
[[nodiscard]] cv::Mat read_frame(const std::filesystem::path& path);

/// Writes an image as PNG: 8 or 16 bit, 1 channel or 3 (BGR), every value as it is.
/// \throws InvalidInput on another type or an empty image; OutputError.
void write_png(const std::filesystem::path& path, const cv::Mat& image);

}  // namespace palpate::sensing
