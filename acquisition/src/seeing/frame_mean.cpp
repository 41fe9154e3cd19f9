// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/frame_mean.h"

#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace palpate::acquisition {

void FrameMean::add(const cv::Mat& frame) {
  if (++count_ == 1) {
    first_ = frame;
    return;
  }
  if (count_ == 2) first_.convertTo(sum_, CV_64F);
  cv::accumulate(frame, sum_);
}

cv::Mat FrameMean::frame() const {
  if (count_ == 1) return first_;
  constexpr double kFullScale = std::numeric_limits<std::uint16_t>::max();
  const double full_scale =
      first_.depth() == CV_8U ? std::numeric_limits<std::uint8_t>::max() : kFullScale;
  cv::Mat mean;
  sum_.convertTo(mean, CV_16U, kFullScale / full_scale / count_);
  return mean;
}

}  // namespace palpate::acquisition
