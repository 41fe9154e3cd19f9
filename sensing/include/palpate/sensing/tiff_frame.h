// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace palpate::sensing {

/// Writes an image as TIFF without compression, which takes little more time than the disk does: 8
/// or 16 bit, 1 or 3 channels (BGR). Values are not converted.
/// \throws InvalidInput if the image is empty or has another type.
/// \throws OutputError if the file cannot be written.
void write_tiff(const std::filesystem::path& path, const cv::Mat& image);

}  // namespace palpate::sensing
