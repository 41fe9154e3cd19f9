// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "camera.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "not_finite.h"
#include "test_surfaces.h"

namespace palpate::view {
namespace {

constexpr double kWidth = 900, kHeight = 700;  // [px]
/// [px] of a picture of this size, in single precision with some operations.
constexpr double kPixelRounding = 1e-2;

Extent box(const Eigen::Vector3d& facing = Eigen::Vector3d::Zero()) {
  Eigen::Matrix3Xd points(3, 2);
  points << -10, 30, 5, 25, 600, 700;
  Extent extent = extent_of(points);
  extent.facing = facing;
  return extent;
}

Camera camera_of(const Extent& extent) {
  Camera camera(extent);
  camera.resize(kWidth, kHeight);
  return camera;
}

TEST(Camera, ShowsAtAPixelWhatItsRayMeets) {
  Camera camera = camera_of(box());
  camera.turn(70, -30);
  camera.zoom(0.7);
  camera.pan(33, 12);
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(0, 0), {450, 350}, {811.5, 13.25}}) {
    const geometry::Ray ray = camera.ray(pixel);
    for (const double distance : {50.0, 400.0}) {
      const auto seen = camera.pixel(ray.origin + distance * ray.direction);
      ASSERT_TRUE(seen.has_value());
      EXPECT_NEAR((*seen - pixel).norm(), 0, 1e-9 * kWidth);
    }
  }
  const geometry::Ray back = camera.ray({450, 350});
  EXPECT_FALSE(camera.pixel(back.origin - back.direction).has_value());
}

TEST(Camera, GivesShadersTheSameView) {
  Camera camera = camera_of(box());
  camera.turn(-200, 90);
  const Shot shot = camera.shot();
  for (const Eigen::Vector3d& point : {Eigen::Vector3d(0, 0, 650), {25, 8, 610}, {-7, 21, 690}}) {
    const Eigen::Vector4d clip = shot.matrix.cast<double>() * point.homogeneous();
    const Eigen::Vector2d pixel((clip.x() / clip.w() + 1) / 2 * kWidth,
                                (1 - clip.y() / clip.w()) / 2 * kHeight);
    EXPECT_NEAR((pixel - *camera.pixel(point)).norm(), 0, kPixelRounding);
    EXPECT_LT(std::abs(clip.z()), clip.w()) << "between the planes of near and far";
  }
  EXPECT_NEAR(static_cast<double>(shot.light.norm()), 1, 1e-6);
}

TEST(Camera, ShowsTheWholeObjectAtFirstAndFillsThePictureWithIt) {
  for (const Eigen::Vector3d& facing :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(0.6, 0, 0.8)}) {
    const Extent extent = box(facing);
    const Camera camera = camera_of(extent);
    double widest = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
      Eigen::Vector3d p;
      for (unsigned k = 0; k < 3; ++k) p[k] = ((corner >> k) & 1u) ? extent.high[k] : extent.low[k];
      const Eigen::Vector2d from_center =
          *camera.pixel(p) - Eigen::Vector2d(kWidth / 2, kHeight / 2);
      widest = std::max({widest, std::abs(from_center.x()) / (kWidth / 2),
                         std::abs(from_center.y()) / (kHeight / 2)});
    }
    EXPECT_LT(widest, 1);
    EXPECT_GT(widest, 0.8);
  }
}

TEST(Camera, LooksAtTheSideThatTheObjectFaces) {
  const Camera camera = camera_of(box({0, 0, -1}));
  EXPECT_GT(camera.ray({kWidth / 2, kHeight / 2}).direction.z(), 0.3);
}

TEST(Camera, TurnsOnceAroundAndReturnsToTheFirstView) {
  Camera camera = camera_of(box());
  const Eigen::Vector2d first = *camera.pixel({20, 10, 620});
  constexpr double kWholeTurn = 2 * std::numbers::pi / 0.008;  // [px]
  camera.turn(kWholeTurn / 2, 0);
  EXPECT_GT((*camera.pixel({20, 10, 620}) - first).norm(), 20);
  camera.turn(kWholeTurn / 2, 0);
  EXPECT_NEAR((*camera.pixel({20, 10, 620}) - first).norm(), 0, 1e-6);
  camera.turn(0, 1e6);
  camera.pan(100, 100);
  camera.zoom(3);
  EXPECT_TRUE(camera.shot().matrix.allFinite()) << "straight above";
  camera.home();
  EXPECT_NEAR((*camera.pixel({20, 10, 620}) - first).norm(), 0, 1e-6);
}

TEST(Extent, LeavesOutPointsThatAreNotKnown) {
  Eigen::Matrix3Xd points(3, 3);
  points << 1, kNaN, 5, 2, 0, 2, 3, 0, 3;
  const Extent extent = extent_of(points);
  EXPECT_EQ(extent.low, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(extent.high, Eigen::Vector3d(5, 2, 3));
  EXPECT_EQ(extent.diagonal, 4);
  EXPECT_EQ(extent_of(Eigen::Matrix3Xd(3, 0)).diagonal, 1) << "a camera needs some length";
}

TEST(Extent, TellsASheetFromASphere) {
  EXPECT_NEAR(
      (extent_of(geometry::test::flat_sheet(3, 4, 2)).facing - Eigen::Vector3d(0, 0, 1)).norm(), 0,
      1e-12);
  EXPECT_NEAR(extent_of(geometry::test::icosphere(2, 5)).facing.norm(), 0, 1e-12);
}

}  // namespace
}  // namespace palpate::view
