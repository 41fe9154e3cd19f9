// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace palpate::sensing {

/// Reads a camera frame from a PNG, TIFF, BMP, JPEG or WebP file: 8 or 16 bit, 1 or 3 channels
/// (BGR). Values are not converted; an alpha channel is dropped, and an orientation tag, by which
/// viewers rotate the image, is ignored.
/// \throws FileError if the file is missing, empty, truncated, damaged or of another type.
[[nodiscard]] cv::Mat read_frame(const std::filesystem::path& path);

/// Returns true if a name has the extension of such a file.
[[nodiscard]] bool has_frame_name(const std::filesystem::path& path);

/// Returns true if an image has lossy compression: JPEG, and WebP unless it is lossless.
/// \throws FileError if the file cannot be read.
[[nodiscard]] bool has_losses(const std::filesystem::path& path);

/// Writes an image as PNG: 8 or 16 bit, 1 or 3 channels (BGR). Values are not converted.
/// \throws InvalidInput if the image is empty or has another type.
/// \throws OutputError if the file cannot be written.
void write_png(const std::filesystem::path& path, const cv::Mat& image);

}  // namespace palpate::sensing
