// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "image/hot_pixels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <random>

namespace palpate::sensing {
namespace {

/// RGGB mosaic of stripes of 17 px (red, yellow, green, ...) times a sinusoid of 7.2 px.
cv::Mat mosaic() {
  cv::Mat image(120, 160, CV_8U);
  for (int v = 0; v < image.rows; ++v) {
    const double wave = 0.55 + 0.4 * std::cos(2 * std::numbers::pi * v / 7.2 + 0.3);
    for (int u = 0; u < image.cols; ++u) {
      const int stripe = u / 17 % 3;
      const bool red = v % 2 == 0 && u % 2 == 0;
      const bool green = v % 2 != u % 2;
      const bool lit = (red && stripe != 2) || (green && stripe != 0);
      image.at<std::uint8_t>(v, u) =
          static_cast<std::uint8_t>(std::lround(255 * (lit ? 0.85 * wave + 0.02 : 0.02)));
    }
  }
  return image;
}

TEST(HotPixels, AFrameWithoutThemStaysAsItIs) {
  const cv::Mat clean = mosaic();
  EXPECT_EQ(cv::norm(without_hot_pixels(clean), clean, cv::NORM_INF), 0);
}

TEST(HotPixels, AreReplacedByWhatTheirNeighboursSaw) {
  const cv::Mat clean = mosaic();
  cv::Mat wide;
  std::mt19937 random(4);
  cv::Mat hot = clean.clone();
  int defects = 0;
  for (auto& pixel : cv::Mat_<std::uint8_t>(hot)) {
    if (random() % 100 >= 3) continue;
    pixel = random() % 4 == 0 ? 0 : 255;
    ++defects;
  }
  ASSERT_GT(defects, 400);
  const auto wrong = [](const cv::Mat& image, const cv::Mat& truth, double step) {
    return cv::countNonZero(cv::abs(image - truth) > step);
  };
  const int before = wrong(hot, clean, 13);
  EXPECT_LT(wrong(without_hot_pixels(hot), clean, 13), 0.35 * before);
  clean.convertTo(wide, CV_16U, 257);
  cv::Mat wide_hot;
  hot.convertTo(wide_hot, CV_16U, 257);
  EXPECT_EQ(wrong(without_hot_pixels(wide_hot), wide, 13 * 257.0),
            wrong(without_hot_pixels(hot), clean, 13));
}

}  // namespace
}  // namespace palpate::sensing
