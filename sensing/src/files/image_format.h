// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace palpate::sensing {

/// Formats of frames, by the first bytes of a file.
enum class ImageFormat { unknown, png, tiff, jpeg, bmp, webp };
[[nodiscard]] ImageFormat image_format(const std::string& bytes);

/// The reason why the bytes of a JPEG or WebP file are not all there, which OpenCV does not report;
/// empty if they are. The lengths of segments and chunks are followed up to the end of the image.
[[nodiscard]] std::string find_jpeg_damage(const std::string& bytes);
[[nodiscard]] std::string find_webp_damage(const std::string& bytes);
[[nodiscard]] std::string find_bmp_damage(const std::string& bytes);

/// Returns true if a WebP file has lossy compression.
[[nodiscard]] bool is_lossy_webp(const std::string& bytes);

}  // namespace palpate::sensing
