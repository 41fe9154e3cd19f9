// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <opencv2/core.hpp>

#include "files/video_capture.h"

namespace palpate::sensing {

/// Returns true if `path` has the extension of a video.
[[nodiscard]] bool is_video(const std::filesystem::path& path);

/// The frames of a video file, in their order.
class VideoFile {
 public:
  /// \throws FileError if it is missing or cannot be opened as a video.
  explicit VideoFile(const std::filesystem::path& path);

  /// Returns the next frame, 8 bit BGR; empty at the end, or where the file is truncated.
  [[nodiscard]] cv::Mat next();
  /// Number of frames that the file declares; 0 if it does not. For files that store only the
  /// duration, the number is rounded from it.
  [[nodiscard]] std::size_t announced_frames() const;
  /// False if pixel values may differ from the camera's: lossy codecs, and colour at less than full
  /// resolution.
  [[nodiscard]] bool is_lossless() const;

 private:
  VideoCapture capture_;
};

}  // namespace palpate::sensing
