// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/corner_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

namespace palpate::sensing {
namespace {

const Eigen::Vector2d kPlace(20.37, 19.72);

/// Four squares that meet in kPlace, in pixels of finite size, blurred; edges along two angles.
cv::Mat_<float> corner_image(double first, double second, double gamma = 1) {
  constexpr int kSize = 41;
  constexpr int kParts = 8;  // samples across a pixel
  cv::Mat_<float> fine(kSize * kParts, kSize * kParts);
  // Jittered samples: on a grid, edges along its axes would be off by up to 1 / 16 px.
  std::mt19937 random(3);
  const auto unit = [&random] { return static_cast<double>(random()) / 4294967296.0; };
  for (int row = 0; row < fine.rows; ++row) {
    for (int column = 0; column < fine.cols; ++column) {
      const double x = (column + unit()) / kParts - 0.5 - kPlace.x();
      const double y = (row + unit()) / kParts - 0.5 - kPlace.y();
      const bool left = std::cos(first) * y - std::sin(first) * x > 0;
      const bool right = std::cos(second) * y - std::sin(second) * x > 0;
      fine(row, column) = left == right ? 180 : 20;
    }
  }
  cv::GaussianBlur(fine, fine, {0, 0}, 1.1 * kParts);
  cv::Mat_<float> image;
  cv::resize(fine, image, {kSize, kSize}, 0, 0, cv::INTER_AREA);
  for (int row = 0; row < kSize; ++row) {
    for (int column = 0; column < kSize; ++column) {
      const double light = (1 + 0.01 * (column - 20) - 0.004 * (row - 20)) / 255;
      image(row, column) = static_cast<float>(
          255 * std::pow(static_cast<double>(image(row, column)) * light, gamma));
    }
  }
  return image;
}

CornerGuess guess_of(double first, double second, const Eigen::Vector2d& miss) {
  return {
      kPlace + miss,
      {{12 * std::cos(first), 12 * std::sin(first)}, {9 * std::cos(second), 9 * std::sin(second)}},
      8};
}

TEST(CornerFit, FindsCornersOfAnyDirectionToAFiftiethOfAPixel) {
  for (const double turn : {0.0, 0.3, 0.8, 1.6, 2.9}) {
    for (const double opening : {1.57, 1.1, 2.1}) {
      const auto found = fit_corner(corner_image(turn, turn + opening),
                                    guess_of(turn + 0.05, turn + opening - 0.04, {0.15, -0.12}));
      ASSERT_TRUE(found) << turn << ' ' << opening;
      EXPECT_LT((*found - kPlace).norm(), 0.02) << turn << ' ' << opening;
    }
  }
}

TEST(CornerFit, AResponseCurveDoesNotMoveTheCorner) {
  const auto found = fit_corner(corner_image(0.4, 1.8, 1 / 2.2), guess_of(0.4, 1.8, {0.12, 0.1}));
  ASSERT_TRUE(found);
  EXPECT_LT((*found - kPlace).norm(), 0.02);
}

TEST(CornerFit, TellsWhereThereIsNoCorner) {
  const CornerGuess guess = guess_of(0, 1.6, {0, 0});
  EXPECT_FALSE(fit_corner(cv::Mat_<float>(41, 41, 100.0F), guess));
  CornerGuess outside = guess;
  outside.place << 5, 20;
  EXPECT_FALSE(fit_corner(corner_image(0, 1.6), outside)) << "the circle leaves the image";
}

}  // namespace
}  // namespace palpate::sensing
