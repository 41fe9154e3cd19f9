// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lit_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calibration/synthetic_board.h"
#include "palpate/sensing/gray_code.h"

namespace palpate::sensing {
namespace {

constexpr ImageSize kShown{256, 192};
constexpr double kLensBlur = 1.4;  // px, standard deviation
/// Relative gradient of the light [1/px].
const Eigen::Vector2d kLightRise(0.004, -0.003);

/// Standard deviation of the blur of lens and pixels, of which each has an area [px].
double camera_blur_px() { return std::sqrt(kLensBlur * kLensBlur + 1.0 / 12); }

/// The panel's point that a point of the image sees, in pixels of both.
Eigen::Vector2d lamp_at(const Eigen::Vector2d& pixel) {
  Eigen::Matrix2d map;
  map << 0.71, 0.06, -0.05, 0.73;
  return map * pixel + Eigen::Vector2d(11.3, 19.7);
}

/// Images of a Gray code on an evenly white board under light that falls off; 16 bit.
std::vector<cv::Mat> photographs() {
  constexpr int kParts = 4;  // samples across a pixel
  const cv::Size size(220, 150);
  std::vector<cv::Mat> photos;
  for (const cv::Mat& shown : draw_gray_code(kShown)) {
    cv::Mat_<float> fine(size * kParts);
    for (int row = 0; row < fine.rows; ++row) {
      for (int column = 0; column < fine.cols; ++column) {
        const Eigen::Vector2d pixel = (Eigen::Vector2d(column, row).array() + 0.5) / kParts - 0.5;
        fine(row, column) = static_cast<float>(std::exp(kLightRise.dot(pixel)) *
                                               (20 + shine(shown, lamp_at(pixel))));
      }
    }
    cv::GaussianBlur(fine, fine, {0, 0}, kLensBlur * kParts);
    cv::Mat photo;
    cv::resize(fine, photo, size, 0, 0, cv::INTER_AREA);
    photo.convertTo(photo, CV_16U, 50);
    photos.push_back(photo);
  }
  return photos;
}

/// Mean error of the points [px of the panel].
Eigen::Vector2d mean_miss(const LitGrid& grid) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (Eigen::Index i = 0; i < grid.camera.cols(); ++i)
    sum += grid.projector.col(i) - lamp_at(grid.camera.col(i));
  return sum / static_cast<double>(grid.camera.cols());
}

TEST(LitGrid, LightThatFallsOffDoesNotMoveThePoints) {
  const std::vector<cv::Mat> images = photographs();
  const cv::Mat_<cv::Vec2f> places = decode_gray_code(images, kShown);
  const cv::Mat_<uchar> on_board(places.size(), 255);
  const auto grid = find_lit_grid(images, places, on_board, camera_blur_px(), kShown);
  ASSERT_TRUE(grid);
  EXPECT_GT(grid->camera.cols(), 150) << "of 18 x 12 cells";
  // In the image, the blurred borders are moved by the blur's variance times the gradient.
  const Eigen::Vector2d moved = lamp_at(camera_blur_px() * camera_blur_px() * kLightRise) -
                                lamp_at(Eigen::Vector2d::Zero());  // px of the panel
  EXPECT_LT(mean_miss(*grid).norm(), 0.1 * moved.norm());
  const auto uncorrected = find_lit_grid(images, places, on_board, 0, kShown);
  ASSERT_TRUE(uncorrected);
  EXPECT_LT((mean_miss(*uncorrected) - moved).norm(), 0.2 * moved.norm());
}

TEST(LitGrid, TellsWhereThereIsNoLight) {
  const std::vector<cv::Mat> images = photographs();
  const cv::Mat_<cv::Vec2f> places = decode_gray_code(images, kShown);
  EXPECT_FALSE(find_lit_grid(images, places, cv::Mat_<uchar>(places.size(), uchar{0}),
                             camera_blur_px(), kShown));
}

}  // namespace
}  // namespace palpate::sensing
