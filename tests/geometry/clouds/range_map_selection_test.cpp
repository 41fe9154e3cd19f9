// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_selection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

constexpr float kNoDepth = std::numeric_limits<float>::quiet_NaN();

Camera table_camera() {
  return {.width = 160, .height = 120, .fx = 150, .fy = 150, .cx = 79.5, .cy = 59.5};
}

/// A table that is seen from above at an angle, with a ball of 60 mm radius on it.
struct Table {
  Vector3d normal = Vector3d(0.1, -0.8, -0.6).normalized();  // towards the camera
  Vector3d point{0, 40, 800};
  Vector3d ball = Vector3d(20, 30, 790) + 60 * normal;
  double radius = 60;

  [[nodiscard]] double height(const Vector3d& p) const { return normal.dot(p - point); }
  [[nodiscard]] bool is_ball(const Vector3d& p) const { return (p - ball).norm() < radius + 0.01; }
};

/// Range map that the camera sees, with normal noise of the depths.
RangeMap seen_table(const Table& table, double noise) {
  RangeMap map{ImageF::Constant(120, 160, kNoDepth), table_camera()};
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0, 1);
  for (int row = 0; row < 120; ++row) {
    for (int col = 0; col < 160; ++col) {
      const Vector3d ray((col - 79.5) / 150, (row - 59.5) / 150, 1);
      double z = table.normal.dot(table.point) / table.normal.dot(ray);
      const double a = ray.squaredNorm(), b = ray.dot(table.ball),
                   c = table.ball.squaredNorm() - table.radius * table.radius;
      if (b * b > a * c) z = std::min(z < 0 ? 1e9 : z, (b - std::sqrt(b * b - a * c)) / a);
      if (z > 0 && z < 3000) map.z(row, col) = static_cast<float>(z + noise * normal(random));
    }
  }
  return map;
}

TEST(RangeMapSelection, KeepsDepthsBetweenNearAndFarIncludingBoth) {
  RangeMap map{ImageF(1, 6), {.width = 6, .height = 1, .fx = 1, .fy = 1, .cx = 0, .cy = 0}};
  map.z << 299.5F, 300, 400, 500, 500.5F, kNoDepth;
  const RangeMapSelection kept = select_depths(map, {.near = 300, .far = 500});
  EXPECT_EQ(kept.known, 5);
  EXPECT_EQ(kept.kept, 3);
  EXPECT_EQ(kept.too_near, 1);
  EXPECT_EQ(kept.too_far, 1);
  EXPECT_EQ(kept.nearest, 299.5);
  EXPECT_EQ(kept.farthest, 500.5);
  EXPECT_TRUE(std::isnan(kept.z(0, 0)));
  EXPECT_EQ(kept.z(0, 1), 300);
  EXPECT_EQ(kept.z(0, 3), 500);
  EXPECT_TRUE(std::isnan(kept.z(0, 4)));
}

TEST(RangeMapSelection, KeepsWhatIsInABoxOfTheCameraFrame) {
  const Table table;
  const RangeMap map = seen_table(table, 0);
  const Eigen::AlignedBox3d left(Vector3d(-5000, -5000, 1), Vector3d(-10, 5000, 5000)),
      right(Vector3d(10, -5000, 1), Vector3d(5000, 5000, 5000));
  const RangeMapSelection both = select_depths(map, {.crop = {left, right}});
  const RangeMapSelection one = select_depths(map, {.crop = {left}});
  for (int row = 0; row < 120; ++row) {
    for (int col = 0; col < 160; ++col) {
      const double x = (col - 79.5) / 150 * static_cast<double>(map.z(row, col));
      EXPECT_EQ(std::isnan(one.z(row, col)), std::isnan(map.z(row, col)) || x > -10);
      EXPECT_EQ(std::isnan(both.z(row, col)), std::isnan(map.z(row, col)) || std::abs(x) < 10);
    }
  }
  EXPECT_EQ(one.kept + one.outside_crop, one.known);
}

TEST(RangeMapSelection, KeepsThePixelsOfAMask) {
  const RangeMap map = seen_table({}, 0);
  PixelMask mask = PixelMask::Constant(120, 160, false);
  mask.block(50, 60, 7, 9).setConstant(true);
  const RangeMapSelection kept = select_depths(map, {}, mask);
  EXPECT_EQ(kept.kept, 63);
  EXPECT_EQ(kept.masked, kept.known - 63);
  EXPECT_EQ(kept.z(53, 62), map.z(53, 62));
  EXPECT_THROW((void)select_depths(map, {}, PixelMask::Constant(160, 120, true)), InvalidInput);
}

TEST(RangeMapSelection, LeavesTheObjectOnATable) {
  const Table table;
  constexpr double kDepthNoise = 1, kTolerance = 4;
  const RangeMap exact = seen_table(table, 0);
  const RangeMapSelection kept =
      select_depths(seen_table(table, kDepthNoise), {.remove_plane = kTolerance});
  ASSERT_TRUE(kept.plane);
  EXPECT_LT(std::acos(std::min(1.0, kept.plane->normal.dot(table.normal))), 0.002);
  EXPECT_NEAR(table.height(kept.plane->point), 0, 0.2);
  const Eigen::Matrix3Xd points = back_project(exact);
  long lost = 0, left = 0, ball = 0;
  for (Eigen::Index pixel = 0; pixel < points.cols(); ++pixel) {
    if (std::isnan(exact.z.data()[pixel])) continue;
    const bool is_kept = !std::isnan(kept.z.data()[pixel]);
    const double height = table.height(points.col(pixel));
    // Points nearer to the plane than tolerance and noise may be left out.
    const bool is_ball = table.is_ball(points.col(pixel)) && height > kTolerance + 4 * kDepthNoise;
    ball += is_ball ? 1 : 0;
    lost += is_ball && !is_kept ? 1 : 0;
    left += height < 0.01 && is_kept ? 1 : 0;
  }
  EXPECT_GT(ball, 300);
  EXPECT_EQ(lost, 0);
  EXPECT_LE(left, 1);  // of 15,000 pixels at four standard deviations
  EXPECT_EQ(kept.on_plane + kept.kept, kept.known);
}

TEST(RangeMapSelection, RemovesWhatIsBehindThePlaneToo) {
  RangeMap map = seen_table({}, 0);
  map.z.block(100, 10, 5, 5) += 300;  // a hole in the table
  const RangeMapSelection kept = select_depths(map, {.remove_plane = 2});
  EXPECT_TRUE(kept.z.block(100, 10, 5, 5).isNaN().all());
}

TEST(RangeMapSelection, FindsThePlaneAmongWhatTheOtherOptionsKeep) {
  // A wall behind the table is larger than it.
  RangeMap map = seen_table({}, 0);
  map.z.topRows(80).setConstant(1500);
  const RangeMapSelection both = select_depths(map, {.far = 1400, .remove_plane = 2});
  ASSERT_TRUE(both.plane);
  EXPECT_GT(both.plane->normal.dot(Table{}.normal), 0.9999);
  EXPECT_LT(select_depths(map, {.remove_plane = 2}).plane->normal.z(), -0.9999);
}

TEST(RangeMapSelection, FindsThePlaneWhateverFewColumnsShow) {
  // A wall behind thin bars, at distances that divide the width.
  constexpr int kWidth = 640, kHeight = 480;
  for (const int pitch : {4, 8, 10, 16, 20, 32}) {
    RangeMap map{
        ImageF::Constant(kHeight, kWidth, 800),
        {.width = kWidth, .height = kHeight, .fx = 600, .fy = 600, .cx = 319.5, .cy = 239.5}};
    for (int col = 0; col < kWidth; col += pitch) map.z.col(col).setConstant(500);
    const RangeMapSelection kept = select_depths(map, {.remove_plane = 2});
    EXPECT_EQ(kept.kept, kHeight * kWidth / pitch) << pitch;
    ASSERT_TRUE(kept.plane);
    EXPECT_NEAR(kept.plane->point.z(), 800, 1e-3) << pitch;
  }
}

TEST(RangeMapSelection, CountsThePixelsWithoutARay) {
  RangeMap map = seen_table({}, 0);
  map.camera.distortion = {-1.5};  // folds the image, so that nothing is seen at its corners
  const Eigen::Matrix2Xd rays = pixel_rays(map.camera);
  long without_ray = 0;
  for (Eigen::Index pixel = 0; pixel < map.z.size(); ++pixel)
    without_ray += rays.col(pixel).hasNaN() && !std::isnan(map.z.data()[pixel]) ? 1 : 0;
  ASSERT_GT(without_ray, 100);
  const RangeMapSelection kept = select_depths(map, {.remove_plane = 4});
  EXPECT_EQ(kept.without_ray, without_ray);
  EXPECT_EQ(kept.kept + kept.on_plane + kept.without_ray, kept.known);
}

TEST(RangeMapSelection, SaysThatThereIsNoPlane) {
  RangeMap map{ImageF(120, 160), table_camera()};
  std::mt19937 random(3);
  std::uniform_real_distribution<float> depth(500, 1500);
  for (float& z : map.z.reshaped()) z = depth(random);
  const RangeMapSelection kept = select_depths(map, {.remove_plane = 1});
  EXPECT_FALSE(kept.plane);
  EXPECT_EQ(kept.on_plane, 0);
  EXPECT_EQ(kept.kept, kept.known);
  map.z.setConstant(kNoDepth);
  EXPECT_EQ(select_depths(map, {.near = 1, .remove_plane = 1}).known, 0);
}

TEST(RangeMapSelection, TakesInfiniteDepthsForUnknown) {
  RangeMap map{ImageF::Constant(120, 160, 500), table_camera()};
  map.z(3, 4) = std::numeric_limits<float>::infinity();
  const RangeMapSelection kept = select_depths(map, {});
  EXPECT_TRUE(std::isnan(kept.z(3, 4)));
  EXPECT_EQ(kept.known, map.z.size() - 1);
  EXPECT_EQ(kept.farthest, 500);
}

TEST(RangeMapSelection, NamesOptionsThatMakeNoSense) {
  const RangeMap map = seen_table({}, 0);
  const auto refused = [&](const RangeMapSelectionOptions& options) -> std::string {
    try {
      (void)select_depths(map, options);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_NE(refused({.near = -1}).find("near is -1 mm"), std::string::npos);
  EXPECT_NE(refused({.far = std::nan("")}).find("far is nan"), std::string::npos);
  EXPECT_NE(refused({.near = 500, .far = 400}).find("must be less than"), std::string::npos);
  EXPECT_NE(refused({.remove_plane = 0}).find("remove_plane is 0"), std::string::npos);
  EXPECT_NE(refused({.crop = {{Vector3d(0, 0, 5), Vector3d(1, 1, 4)}}}).find("z0 < z1"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::geometry
