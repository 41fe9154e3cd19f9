// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_force_errors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

/// Within the axes, whose left end depends on the numbers by a few pixels.
const Region kErrors(110, 140, 1050, 470);
/// The same with the lower end of the axes.
const Region kDownToTheEnd(110, 140, 1050, 485);

/// Commands from -1 to 1 N: too little by 0.1 N where they rise, too much where they fall; a tenth
/// of that once internal forces are compensated.
ForceErrors swept_force() {
  ForceErrors errors{Eigen::VectorXd(40), Eigen::VectorXd(40), Eigen::VectorXd(40)};
  for (int i = 0; i < 40; ++i) {
    errors.commanded(i) = -1 + 2.0 * (i % 20) / 19;
    errors.gravity_only(i) = i < 20 ? -0.1 : 0.1;
    errors.fully_compensated(i) = 0.1 * errors.gravity_only(i);
  }
  return errors;
}

cv::Mat3b error_picture(const ForceErrors& errors) {
  return draw_picture(
      [&](const std::filesystem::path& png) { draw_force_errors(png, errors, "X"); });
}

TEST(DrawForceErrors, PutsTheErrorsAtTheirHeightsAroundZero) {
  const cv::Mat3b picture = error_picture(swept_force());
  EXPECT_EQ(picture.size(), cv::Size(1200, 700));
  const auto rows = [&](const Rgb& color) { return box_of(mask_of(picture, color, 40, kErrors)); };
  const int before = rows(kVermilion).height, after = rows(kBlue).height;
  // Ten times as high, apart from the size of the marks.
  EXPECT_GT(before, 250);
  EXPECT_NEAR(after - 8, (before - 8) / 10.0, 8);
  EXPECT_NEAR(rows(kVermilion).y + before / 2.0, rows(kBlue).y + after / 2.0, 4);
  EXPECT_NEAR(rows(kVermilion).width, rows(kBlue).width, 4);
}

TEST(DrawForceErrors, DrawsTheLineOfZeroEvenIfAllErrorsLieOnOneSide) {
  ForceErrors errors = swept_force();
  errors.gravity_only.setConstant(0.1);
  errors.fully_compensated.setConstant(0.05);
  const cv::Mat3b picture = error_picture(errors);
  const auto row = [&](const Rgb& color) {
    return center_of(mask_of(picture, color, 40, kDownToTheEnd)).y();
  };
  // Zero is as far below 0.05 N as that is below 0.1 N.
  EXPECT_NEAR(row(kBlack) - row(kBlue), row(kBlue) - row(kVermilion), 6);
}

TEST(DrawForceErrors, RefusesInputThatDoesNotFit) {
  ForceErrors errors = swept_force();
  const auto attempt = [&errors](const std::filesystem::path& png) {
    draw_force_errors(png, errors, "");
  };
  errors.fully_compensated(3) = std::nan("");
  expect_refused(attempt, "fully_compensated: force 3 is nan N");
  errors = swept_force();
  errors.gravity_only.conservativeResize(7);
  expect_refused(attempt, "gravity_only: has 7 entries where 40 are needed");
  errors = {};
  expect_refused(attempt, "commanded: is empty");
}

TEST(DrawForceErrors, SaysWhenItCannotWrite) {
  expect_unwritable(
      [](const std::filesystem::path& png) { draw_force_errors(png, swept_force(), ""); });
}

}  // namespace
}  // namespace palpate::pictures
