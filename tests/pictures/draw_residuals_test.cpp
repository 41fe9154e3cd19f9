// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_residuals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

/// The places of the two images.
const Region kLeft(24, 110, 560, 430);
const Region kRight(612, 110, 560, 430);

/// One point in the middle of each image; the camera's residual points right, the projector's down.
std::vector<ResidualImage> make_images() {
  const auto view = [](const Eigen::Vector2d& at, const Eigen::Vector2d& residual) {
    return ResidualView{"pose", at, residual};
  };
  return {{"camera", 640, 480, {view({319.5, 239.5}, {2, 0})}},
          {"projector", 640, 480, {view({319.5, 239.5}, {0, 0.5})}}};
}

cv::Mat3b residuals_picture(const std::vector<ResidualImage>& images) {
  return draw_picture(
      [&](const std::filesystem::path& png) { draw_residuals(png, images, "Residuals"); });
}

TEST(DrawResiduals, ArrowsPointAlongTheResiduals) {
  const cv::Mat3b picture = residuals_picture(make_images());
  EXPECT_EQ(picture.size(), cv::Size(1200, 900));
  const cv::Rect right = box_of(mask_of(picture, kBlue, 60, kLeft));
  const cv::Rect down = box_of(mask_of(picture, kVermilion, 60, kRight));
  EXPECT_GT(right.width, 35);
  EXPECT_LT(right.height, 10);
  EXPECT_GT(down.height, 35);
  EXPECT_LT(down.width, 10);
  // The arrow to the right begins, the arrow down ends, away from the point.
  std::vector<ResidualImage> images = make_images();
  images[0].views[0].residual *= -1;
  const cv::Rect left = box_of(mask_of(residuals_picture(images), kBlue, 60, kLeft));
  EXPECT_LT(left.x, right.x - 30);
}

TEST(DrawResiduals, PointsLieWhereTheImageHasThem) {
  std::vector<ResidualImage> images = make_images();
  const auto place = [&](double x, double y) {
    images[0].views[0].at << x, y;
    images[0].views[0].residual.setZero();
    return center_of(mask_of(residuals_picture(images), kBlue, 60, kLeft));
  };
  const Eigen::Vector2d first = place(100, 100);
  const Eigen::Vector2d moved = place(300, 200) - first;
  EXPECT_NEAR(moved.x() / moved.y(), 2, 0.05);
  EXPECT_GT(moved.y(), 50);
}

TEST(DrawResiduals, OneImageIsEnough) {
  std::vector<ResidualImage> images = make_images();
  images.pop_back();
  EXPECT_GT(cv::countNonZero(mask_of(residuals_picture(images), kBlue, 60, {0, 110, 1200, 430})),
            20);
}

TEST(DrawResiduals, ViewsAreCountedInWholeNumbers) {
  // One view stands in the middle of an axis from 0 to 2.
  const cv::Mat1b grid =
      mask_of(residuals_picture(make_images()), {225, 225, 225}, 25, {110, 640, 1070, 150});
  int lines = 0;
  bool inside = false;
  for (int x = 0; x < grid.cols; ++x) {
    const bool upright = cv::countNonZero(grid.col(x)) > grid.rows * 3 / 4;
    if (upright && !inside) ++lines;
    inside = upright;
  }
  EXPECT_GE(lines, 1);
  EXPECT_LE(lines, 3);
}

TEST(DrawResiduals, RefusesInputThatDoesNotFit) {
  std::vector<ResidualImage> images;
  const auto attempt = [&](const std::filesystem::path& png) { draw_residuals(png, images, ""); };
  expect_refused(attempt, "images");
  images = make_images();
  images[1].views[0].residual.resize(2, 3);
  expect_refused(attempt, "projector, view 'pose'");
  images = make_images();
  images[0].views[0].at(0, 0) = std::nan("");
  expect_refused(attempt, "camera, view 'pose'");
  images[0].views.clear();
  expect_refused(attempt, "there is no view");
  images = make_images();
  images[0].width = 0;
  expect_refused(attempt, "camera");
}

TEST(DrawResiduals, SaysWhenItCannotWrite) {
  expect_unwritable(
      [](const std::filesystem::path& png) { draw_residuals(png, make_images(), ""); });
}

}  // namespace
}  // namespace palpate::pictures
