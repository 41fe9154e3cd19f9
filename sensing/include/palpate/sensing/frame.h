// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace palpate::sensing {

/// Reads a camera frame from a PNG or TIFF file: 8 or 16 bit, 1 or 3 channels (BGR). Values are not
/// converted; an alpha channel is dropped.
/// \throws FileError if the file is missing, empty, truncated, damaged or of another type.
[[nodiscard]] cv::Mat read_frame(const std::filesystem::path& path);

/// Writes an image as PNG: 8 or 16 bit, 1 or 3 channels (BGR). Values are not converted.
/// \throws InvalidInput if the image is empty or has another type.
/// \throws OutputError if the file cannot be written.
void write_png(const std::filesystem::path& path, const cv::Mat& image);

}  // namespace palpate::sensing
