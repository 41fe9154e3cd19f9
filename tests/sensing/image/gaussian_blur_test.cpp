// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "image/gaussian_blur.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

namespace palpate::sensing {
namespace {

TEST(GaussianBlur, DampsASinusoidAsTheoryHasIt) {
  constexpr double kSigma = 1.3, kAcross = 9, kDown = 7;
  const double w = 2 * std::numbers::pi;
  const auto wave = [&](int row, int column) {
    return std::cos(w * column / kAcross) * std::cos(w * row / kDown);
  };
  cv::Mat image(60, 70, CV_32FC1);
  image.forEach<float>(
      [&](float& v, const int* at) { v = static_cast<float>(wave(at[0], at[1])); });
  const cv::Mat blurred = gaussian_blur(image, kSigma, Border::black);
  const double damping =
      std::exp(-kSigma * kSigma * w * w * (1 / (kAcross * kAcross) + 1 / (kDown * kDown)) / 2);
  for (int row = 10; row < 50; ++row) {
    for (int column = 10; column < 60; ++column) {
      // The effects of the bell's cut-off and of its sampling are below 1e-4.
      EXPECT_NEAR(blurred.at<float>(row, column), damping * wave(row, column), 1e-4);
    }
  }
}

TEST(GaussianBlur, KeepsAnEvenImageOrDarkensItsBorder) {
  const cv::Mat image(5, 6, CV_32FC3, cv::Scalar(0.2, 0.5, 0.7));  // smaller than the bell
  EXPECT_LT(cv::norm(gaussian_blur(image, 2, Border::replicated), image, cv::NORM_INF), 1e-6);
  const cv::Mat large(50, 60, CV_32FC1, cv::Scalar(0.5));
  const cv::Mat dark = gaussian_blur(large, 2, Border::black);
  EXPECT_NEAR(dark.at<float>(25, 30), 0.5F, 1e-6);
  EXPECT_NEAR(dark.at<float>(25, 0), 0.5 * (0.5 + 0.5 / (2 * std::sqrt(2 * std::numbers::pi))),
              1e-4);
}

TEST(GaussianBlur, LeavesAnImageAloneWithoutASigma) {
  const cv::Mat image(5, 6, CV_32FC3, cv::Scalar(0.2, 0.5, 0.7));
  EXPECT_EQ(cv::norm(gaussian_blur(image, 0, Border::black), image, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace palpate::sensing
