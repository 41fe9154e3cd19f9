// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The whole of the module `video_capture`.
#include <algorithm>
#include <chrono>
#include <memory>
#include <opencv2/videoio.hpp>
#include <vector>

#include "files/video_capture.h"

namespace {

palpate::sensing::VideoCapture functions_of(const std::shared_ptr<cv::VideoCapture>& capture) {
  return {.read = [capture](cv::Mat& frame) { return capture->read(frame); },
          .property = [capture](int property) { return capture->get(property); }};
}

palpate::sensing::VideoCapture open(const std::string& path) {
  // Open by name, because OpenCV's other backends take some names for patterns of image files.
  const auto capture = std::make_shared<cv::VideoCapture>(path, cv::CAP_FFMPEG);
  if (!capture->isOpened()) return {};
  return functions_of(capture);
}

palpate::sensing::DeviceCapture open_device(int number) {
  const auto capture = std::make_shared<cv::VideoCapture>(number, cv::CAP_V4L2);
  if (!capture->isOpened()) return {};
  return {.capture = functions_of(capture),
          .set = [capture](int property, double value) { return capture->set(property, value); },
          .wait =
              [capture](std::chrono::milliseconds most) {
                std::vector<int> ready;
                // OpenCV takes 0 for "without end".
                const std::chrono::nanoseconds wait =
                    std::max<std::chrono::nanoseconds>(most, std::chrono::nanoseconds(1));
                return cv::VideoCapture::waitAny({*capture}, ready, wait.count());
              }};
}

}  // namespace

const palpate::sensing::VideoCaptures palpate_video_capture{&open, &open_device};
