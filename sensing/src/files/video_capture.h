// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <opencv2/core/mat.hpp>
#include <string>

namespace palpate::sensing {

/// A video that is open in FFmpeg. Empty functions if it could not be opened.
struct VideoCapture {
  /// The next frame into memory that a later call may reuse; false at the end.
  std::function<bool(cv::Mat& frame)> read;
  /// As cv::VideoCapture::get().
  std::function<double(int property)> property;
};

/// What the module `video_capture` does: OpenCV's reading of videos, which needs 244 shared
/// libraries.
struct VideoCaptures {
  VideoCapture (*open)(const std::string& path);
};

}  // namespace palpate::sensing

extern "C" const palpate::sensing::VideoCaptures palpate_video_capture;
