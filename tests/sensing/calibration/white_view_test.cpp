// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/white_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::sensing {
namespace {

/// [px] So long that the average along the rows has three stages and reaches 14 px to each side.
constexpr double kLongPeriod = 30;
/// [rad] of the sinusoid at row 0, and the lead of that of the overexposed surface.
constexpr double kPhase = 0.4;
constexpr double kAhead = 1.5;
/// Columns of the surface that is overexposed.
constexpr int kFirstBright = 100;
constexpr int kLastBright = 120;

/// A white sinusoid down the rows; the bright columns are clipped at its crests.
cv::Mat partly_overexposed() {
  cv::Mat_<cv::Vec3w> image(400, 240);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const bool bright = column >= kFirstBright && column <= kLastBright;
      const double angle =
          2 * std::numbers::pi * row / kLongPeriod + kPhase + (bright ? kAhead : 0);
      const double light = bright ? 0.8 + 0.5 * std::cos(angle) : 0.4 + 0.3 * std::cos(angle);
      const auto value = static_cast<ushort>(std::lround(65535 * std::min(light, 1.0)));
      image(row, column) = {value, value, value};
    }
  }
  return image;
}

TEST(WhiteView, NoReliablePhaseIsMixedWithOverexposedPixels) {
  const Carrier carrier{.along = 2 * std::numbers::pi / kLongPeriod};
  const WhiteView view =
      measure_white_view(partly_overexposed(), carrier, Eigen::Matrix3d::Identity(), {}, {});
  int left = 0, right = 0;
  double largest_error = 0;  // rad
  for (long row = 0; row < view.reliable.rows(); ++row) {
    for (long column = 0; column < view.reliable.cols(); ++column) {
      if (view.reliable(row, column) == 0) continue;
      ++(column < kFirstBright ? left : right);
      const float phase = std::atan2(view.green.im(row, column), view.green.re(row, column));
      largest_error = std::max(largest_error, std::abs(static_cast<double>(phase) - kPhase));
    }
  }
  // The image is rounded to 1e-5 of full scale; a thousandth of the other surface's light is 1e-3.
  EXPECT_LT(largest_error, 3e-4);
  EXPECT_GT(left, 1000);
  EXPECT_GT(right, 1000);
}

}  // namespace
}  // namespace palpate::sensing
