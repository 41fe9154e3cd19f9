// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace palpate::acquisition {

/// The mean of frames that show the same, of which one at a time is in memory.
class FrameMean {
 public:
  /// \param frame of 8 or 16 bits; all of one size and type.
  void add(const cv::Mat& frame);
  /// Of one frame, itself; of more, with 16 bits, so that the mean of 8-bit frames is not rounded
  /// to 8 bits. \pre There is a frame.
  [[nodiscard]] cv::Mat frame() const;

 private:
  int count_ = 0;
  cv::Mat first_;
  cv::Mat sum_;  // 64-bit numbers; empty until there are two
};

}  // namespace palpate::acquisition
