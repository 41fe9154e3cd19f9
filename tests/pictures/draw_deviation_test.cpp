// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_deviation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "not_finite.h"
#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

cv::Mat3b deviation_picture(const geometry::ImageF& sigma) {
  return draw_picture(
      [&](const std::filesystem::path& png) { draw_deviation(png, sigma, "Sigma"); });
}

TEST(DrawDeviation, ScaleBeginsAtZeroAndIsNotSpoiltByAFewLargeOnes) {
  geometry::ImageF sigma = geometry::ImageF::Constant(48, 64, 0.5F);
  sigma.leftCols(32) = 0.25F;
  sigma(3, 3) = 100;
  const cv::Mat3b picture = deviation_picture(sigma);
  const auto color = [&](double x) {
    return pixel(picture, kImage.x + static_cast<int>(x * kImage.width),
                 kImage.y + kImage.height / 2);
  };
  EXPECT_LE(color_distance(color(0.75), color_at(ColorMap::sequential, 1.0)), 2);
  EXPECT_LE(color_distance(color(0.25), color_at(ColorMap::sequential, 0.5)), 2);
}

TEST(DrawDeviation, UnknownIsGreyAndNothingKnownIsRefused) {
  geometry::ImageF sigma = geometry::ImageF::Constant(48, 64, 0.1F);
  sigma.topRows(8) = kFloatNaN;
  EXPECT_NEAR(cv::countNonZero(mask_of(deviation_picture(sigma), kUnknownColor, 1, kImage)),
              kImage.area() / 6.0, 0.01 * kImage.area());
  sigma.setConstant(kFloatNaN);
  expect_refused([&](const std::filesystem::path& png) { draw_deviation(png, sigma, ""); },
                 "deviations: holds no finite value");
}

}  // namespace
}  // namespace palpate::pictures
