// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/projector_panel.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "image/gaussian_blur.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::sensing {

cv::Mat panel_light(const cv::Mat& image, const geometry::Camera& projector,
                    const VirtualSensor& sensor, const std::string& what) {
  if (image.cols != projector.width || image.rows != projector.height) {
    throw InvalidInput(what + ": has " + std::to_string(image.cols) + " x " +
                       std::to_string(image.rows) + " px; the projector has " +
                       std::to_string(projector.width) + " x " + std::to_string(projector.height));
  }
  const int depth = image.depth();
  const int channels = image.channels();
  if ((depth != CV_8U && depth != CV_16U && depth != CV_32F) || (channels != 1 && channels != 3)) {
    throw InvalidInput(what + ": 8 bit, 16 bit or float and 1 or 3 channels are expected");
  }
  cv::Mat values;
  image.convertTo(values, CV_32F, depth == CV_8U ? 1 / 255.0 : depth == CV_16U ? 1 / 65535.0 : 1);
  cv::Mat light(image.size(), CV_32FC3);
  for (int row = 0; row < image.rows; ++row) {
    const float* from = values.ptr<float>(row);
    float* to = light.ptr<float>(row);
    float last = -1;  // no value of an image
    for (int i = 0; i < 3 * image.cols; ++i) {
      const float value = from[channels == 1 ? i / 3 : i];
      if (value == last) {  // frequent in panels of a sequence, and a power takes long
        to[i] = to[i - 1];
        continue;
      }
      require(
          [&] {
            return what + ": the value at row " + std::to_string(row) + ", column " +
                   std::to_string(i / 3);
          },
          static_cast<double>(value), at_least(0).at_most(1));
      to[i] = static_cast<float>(sensor.projector_black +
                                 (1 - sensor.projector_black) *
                                     std::pow(static_cast<double>(value), sensor.projector_gamma));
      last = value;
    }
  }
  return gaussian_blur(light, sensor.projector_blur_px, Border::black);
}

float light_at(const cv::Mat& light, const Eigen::Vector2d& pixel, int channel) {
  const double x = std::clamp<double>(pixel.x(), 0, light.cols - 1);
  const double y = std::clamp<double>(pixel.y(), 0, light.rows - 1);
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const int right = std::min(left + 1, light.cols - 1), below = std::min(top + 1, light.rows - 1);
  const auto fx = static_cast<float>(x - left), fy = static_cast<float>(y - top);
  const float* upper = light.ptr<float>(top) + channel;
  const float* lower = light.ptr<float>(below) + channel;
  return (1 - fy) * ((1 - fx) * upper[3 * left] + fx * upper[3 * right]) +
         fy * ((1 - fx) * lower[3 * left] + fx * lower[3 * right]);
}

}  // namespace palpate::sensing
