// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/corner_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace palpate::sensing {
namespace {

const Eigen::Vector2d kPlace(20.37, 19.72);

/// Relative gradient of the light [1/px], which falls onto the squares before the lens blurs them.
const Eigen::Vector2d kRise(0.01, -0.004);
constexpr double kBlur = 1.1;  // px

/// Four squares that meet in kPlace, in pixels of finite size, blurred; edges along two angles,
/// with a curvature [1/px].
cv::Mat_<float> corner_image(double first, double second, double gamma = 1, double curvature = 0) {
  constexpr int kSize = 41;
  constexpr int kParts = 8;  // samples across a pixel
  cv::Mat_<float> fine(kSize * kParts, kSize * kParts);
  for (int row = 0; row < fine.rows; ++row) {
    for (int column = 0; column < fine.cols; ++column) {
      const double x = (column + 0.5) / kParts - 0.5 - kPlace.x();
      const double y = (row + 0.5) / kParts - 0.5 - kPlace.y();
      // Over the width of a sample, a side turns into the other: hard edges on a grid of samples
      // would be off by up to 1 / 16 px.
      const auto side = [&](double angle) {
        const double along = std::cos(angle) * x + std::sin(angle) * y;
        const double beyond =
            std::cos(angle) * y - std::sin(angle) * x - curvature / 2 * along * along;
        return std::clamp(beyond * kParts, -1.0, 1.0);
      };
      const double light = 1 + kRise.x() * x + kRise.y() * y;
      fine(row, column) = static_cast<float>(light * (100 + 80 * side(first) * side(second)) / 255);
    }
  }
  cv::GaussianBlur(fine, fine, {0, 0}, kBlur * kParts);
  cv::Mat_<float> image;
  cv::resize(fine, image, {kSize, kSize}, 0, 0, cv::INTER_AREA);
  cv::pow(image, gamma, image);
  image *= 255;
  return image;
}

CornerGuess guess_of(double first, double second, const Eigen::Vector2d& miss, double radius = 8) {
  return {
      kPlace + miss,
      {{12 * std::cos(first), 12 * std::sin(first)}, {9 * std::cos(second), 9 * std::sin(second)}},
      radius};
}

TEST(CornerFit, FindsCornersOfAnyDirectionToAHundredthOfAPixel) {
  for (const double turn : {0.0, 0.3, 0.8, 1.6, 2.9}) {
    for (const double opening : {1.57, 1.1, 2.1}) {
      const auto found = fit_corner(corner_image(turn, turn + opening),
                                    guess_of(turn + 0.05, turn + opening - 0.04, {0.15, -0.12}));
      ASSERT_TRUE(found) << turn << ' ' << opening;
      EXPECT_LT((found->place - kPlace).norm(), 0.01) << turn << ' ' << opening;
    }
  }
}

TEST(CornerFit, LightThatFallsOffDoesNotMoveTheCorner) {
  const auto found = fit_corner(corner_image(0.4, 1.8), guess_of(0.4, 1.8, {0.1, 0.1}));
  ASSERT_TRUE(found);
  const double pixel = 1.0 / 12;  // px^2, the variance of a pixel's area
  EXPECT_NEAR(found->blur, std::sqrt(kBlur * kBlur + pixel), 0.01);
  const double moved = found->blur * found->blur * kRise.norm();  // px, if it were not corrected
  EXPECT_LT((found->place - kPlace).norm(), 0.1 * moved);
}

TEST(CornerFit, AResponseCurveDoesNotMoveTheCorner) {
  const auto found = fit_corner(corner_image(0.4, 1.8, 1 / 2.2), guess_of(0.4, 1.8, {0.12, 0.1}));
  ASSERT_TRUE(found);
  EXPECT_LT((found->place - kPlace).norm(), 0.02);
}

// As by a wide-angle lens (k1 = -0.2 at 520 px) near the border of the image: over this circle, the
// edges leave straight lines by 0.2 px.
TEST(CornerFit, EdgesBentByALensDoNotMoveTheCorner) {
  for (const double turn : {0.0, 0.3, 0.8, 2.9}) {
    const auto found = fit_corner(corner_image(turn, turn + 1.5, 1, 0.002),
                                  guess_of(turn, turn + 1.5, {0.1, -0.1}, 15));
    ASSERT_TRUE(found) << turn;
    EXPECT_LT((found->place - kPlace).norm(), 0.01) << turn;
  }
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
