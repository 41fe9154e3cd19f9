// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The whole of the module `video_capture`.
#include <memory>
#include <opencv2/videoio.hpp>

#include "files/video_capture.h"

namespace {

palpate::sensing::VideoCapture open(const std::string& path) {
  // Open by name, because OpenCV's other backends take some names for patterns of image files.
  const auto capture = std::make_shared<cv::VideoCapture>(path, cv::CAP_FFMPEG);
  if (!capture->isOpened()) return {};
  return {.read = [capture](cv::Mat& frame) { return capture->read(frame); },
          .property = [capture](int property) { return capture->get(property); }};
}

}  // namespace

const palpate::sensing::VideoCaptures palpate_video_capture{&open};
