// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <string>
#include <vector>

#include "file_testing.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

// Coordinates are near 1 and some 30 operations deep.
constexpr double kCameraRounding = 1e-13;
constexpr double kRoundingPx = 1e-10;  // the same, times a focal length

Camera pinhole() {
  return {.width = 640, .height = 480, .fx = 610.3, .fy = 598.7, .cx = 318.2, .cy = 243.9};
}

std::vector<Camera> lenses() {
  std::vector<Camera> cameras(5, pinhole());
  cameras[1].distortion = {-0.28, 0.07, 0.0011, -0.0007, -0.01};        // barrel
  cameras[2].distortion = {0.21, 0.05, -0.002, 0.0013};                 // pincushion
  cameras[3].distortion = {6.1, 2.3, 4e-4, -8e-4, 0.4, 6.4, 4.2, 1.1};  // rational
  cameras[4].distortion = {-0.05, 0, 0.01, 0.02};                       // tilted lens
  return cameras;
}

cv::Mat matrix_of(const Camera& camera) {
  return (cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
}

TEST(Camera, DistortAgreesWithOpenCv) {
  for (const Camera& camera : lenses())
    for (double x = -0.5; x <= 0.5; x += 0.1)
      for (double y = -0.4; y <= 0.4; y += 0.1) {
        std::vector<cv::Point2d> pixels;
        cv::projectPoints(std::vector<cv::Point3d>{{3 * x, 3 * y, 3}}, cv::Vec3d(), cv::Vec3d(),
                          matrix_of(camera), camera.distortion, pixels);
        const Eigen::Vector2d pixel = distort(camera, {x, y});
        EXPECT_NEAR(pixel.x(), pixels[0].x, kRoundingPx);
        EXPECT_NEAR(pixel.y(), pixels[0].y, kRoundingPx);
      }
}

TEST(Camera, UndistortAgreesWithOpenCv) {
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 500, 1e-14);
  constexpr double kOpenCv = 1e-9;  // its fixed-point iteration converges linearly
  for (const Camera& camera : lenses())
    for (double u = 0; u < 640; u += 71)
      for (double v = 0; v < 480; v += 67) {
        std::vector<cv::Point2d> normalized;
        cv::undistortPoints(std::vector<cv::Point2d>{{u, v}}, normalized, matrix_of(camera),
                            camera.distortion, cv::noArray(), cv::noArray(), criteria);
        const Eigen::Vector2d ours = undistort(camera, {u, v});
        EXPECT_NEAR(ours.x(), normalized[0].x, kOpenCv);
        EXPECT_NEAR(ours.y(), normalized[0].y, kOpenCv);
      }
}

TEST(Camera, UndistortInvertsDistortToRounding) {
  for (const Camera& camera : lenses())
    for (double x = -0.5; x <= 0.5; x += 0.05)
      for (double y = -0.4; y <= 0.4; y += 0.05) {
        const Eigen::Vector2d back = undistort(camera, distort(camera, {x, y}));
        EXPECT_NEAR(back.x(), x, kCameraRounding);
        EXPECT_NEAR(back.y(), y, kCameraRounding);
      }
}

TEST(Camera, APinholeIsAffine) {
  const Eigen::Vector2d pixel = distort(pinhole(), {0.3, -0.2});
  EXPECT_DOUBLE_EQ(pixel.x(), 318.2 + 0.3 * 610.3);
  EXPECT_DOUBLE_EQ(pixel.y(), 243.9 - 0.2 * 598.7);
}

TEST(Camera, APixelBeyondTheFoldOfTheLensHasNoRay) {
  Camera camera = pinhole();
  camera.distortion = {-0.3};
  // r - 0.3 r^3 is greatest at r = sqrt(1 / 0.9), where it is 2/3 of that: nothing is shown farther
  // out.
  const double fold = 2.0 / 3 / std::sqrt(0.9);
  const auto at = [&](double radius) {
    return undistort(camera, {camera.cx + camera.fx * radius, camera.cy});
  };
  EXPECT_NEAR(distort(camera, at(0.99 * fold)).x(), camera.cx + camera.fx * 0.99 * fold,
              kRoundingPx);
  EXPECT_LT(at(0.99 * fold).x(), std::sqrt(1 / 0.9));
  for (const double radius : {1.001 * fold, 1.5 * fold, 4 * fold}) EXPECT_TRUE(at(radius).hasNaN());
}

TEST(Camera, ASecondBranchOfTheLensModelIsNotTaken) {
  Camera camera = pinhole();
  // r - r^3 + 0.4 r^5 rises to 0.37 at 0.66, falls, and rises again past 1.07: a pixel at 0.6 is
  // reached by the model at r = 1.3 only, across two folds.
  camera.distortion = {-1, 0.4};
  EXPECT_TRUE(undistort(camera, {camera.cx + 0.6 * camera.fx, camera.cy}).hasNaN());
}

TEST(Camera, NanStaysNan) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Camera& camera : lenses()) EXPECT_TRUE(undistort(camera, {nan, 3}).hasNaN());
}

TEST(Camera, PixelRaysAreThoseOfEachPixelRowAfterRow) {
  std::vector<Camera> cameras = lenses();
  cameras.push_back(pinhole());
  cameras.back().distortion = {-1.6, 0.9};  // folded within the image: corners have no ray
  for (const Camera& camera : cameras) {
    // Near a fold rounding is magnified without bound; the last pixel before it is not that near.
    const double tolerance = (&camera == &cameras.back() ? 100 : 1) * kCameraRounding;
    const Eigen::Matrix2Xd rays = pixel_rays(camera);
    ASSERT_EQ(rays.cols(), 640 * 480);
    for (int row = 0; row < 480; row += 7)
      for (int col = 0; col < 640; ++col) {
        const Eigen::Vector2d ray = undistort(camera, {col, row});
        if (ray.hasNaN())
          EXPECT_TRUE(rays.col(row * 640 + col).hasNaN());
        else
          EXPECT_LT((rays.col(row * 640 + col) - ray).norm(), tolerance);
      }
  }
  EXPECT_TRUE(pixel_rays(cameras.back()).col(0).hasNaN());
}

TEST(Camera, RefusesABadCameraByName) {
  const auto check = [](auto change, const std::string& words) {
    Camera camera = pinhole();
    change(camera);
    EXPECT_THROWS_MESSAGE(check_camera(camera, "the projector"), InvalidInput, words);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NO_THROW(check_camera(pinhole(), "the projector"));
  check([](Camera& camera) { camera.width = 0; }, "the projector: width is 0 px; it must be >= 1");
  check([](Camera& camera) { camera.height = -1; }, "height is -1 px; it must be >= 1");
  check([](Camera& camera) { camera.width = camera.height = 100000; }, "at most 2^28");
  check([](Camera& camera) { camera.fx = -600; }, "fx is -600 px; it must be > 0 and finite");
  check([&](Camera& camera) { camera.fy = nan; }, "fy is nan px; it must be > 0 and finite");
  check([&](Camera& camera) { camera.cx = nan; }, "cx is nan px; it must be finite");
  check([&](Camera& camera) { camera.distortion[4] = nan; }, "coefficient 4");
  EXPECT_THROW(static_cast<void>(pixel_rays(Camera{})), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
