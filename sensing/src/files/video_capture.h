// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <string>

namespace palpate::sensing {

/// A video that is open in FFmpeg. Empty functions if it could not be opened.
struct VideoCapture {
  /// Reads the next frame into memory that a later call may reuse; false at the end.
  std::function<bool(cv::Mat& frame)> read;
  /// As cv::VideoCapture::get().
  std::function<double(int property)> property;
};

/// A camera that is open in V4L2. Empty functions if it could not be opened.
struct DeviceCapture {
  VideoCapture capture;
  /// As cv::VideoCapture::set().
  std::function<bool(int property, double value)> set;
  /// True if a frame is there, after waiting for it at most this long. \throws cv::Exception.
  std::function<bool(std::chrono::milliseconds)> wait;
};

/// Functions of the module `video_capture`: OpenCV's reading of videos and cameras, which needs 244
/// shared libraries.
struct VideoCaptures {
  VideoCapture (*open)(const std::string& path);
  DeviceCapture (*open_device)(int number);
};

}  // namespace palpate::sensing

extern "C" const palpate::sensing::VideoCaptures palpate_video_capture;
