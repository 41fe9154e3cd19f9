// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_undistortion.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "not_finite.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

constexpr double kRoundingOfDepths = 3e-7;  // of interpolated float depths, relative

Camera lens_of(const std::array<double, 8>& distortion) {
  return {.width = 81,
          .height = 63,
          .fx = 90.3,
          .fy = 88.1,
          .cx = 41.7,
          .cy = 29.4,
          .distortion = distortion};
}

using DepthOfRay = std::function<double(double x, double y)>;

RangeMap seen_through(const Camera& camera, const DepthOfRay& depth) {
  RangeMap map{ImageF(camera.height, camera.width), camera};
  for (int row = 0; row < camera.height; ++row) {
    for (int col = 0; col < camera.width; ++col) {
      const Eigen::Vector2d ray = undistort(camera, {col, row});
      map.z(row, col) = static_cast<float>(depth(ray.x(), ray.y()));
    }
  }
  return map;
}

/// Calls `visit` with each known depth and its ray through a pinhole; returns how many there are.
int for_each_depth(const RangeMap& map, const std::function<void(double, double, double)>& visit) {
  int known = 0;
  for (int row = 0; row < map.camera.height; ++row) {
    for (int col = 0; col < map.camera.width; ++col) {
      if (std::isnan(map.z(row, col))) continue;
      visit(static_cast<double>(map.z(row, col)), (col - map.camera.cx) / map.camera.fx,
            (row - map.camera.cy) / map.camera.fy);
      ++known;
    }
  }
  return known;
}

double tilted_plane(double x, double y) { return 500 / (1 + 0.6 * x - 0.3 * y); }

TEST(RangeMapUndistortion, AnObliquePlaneIsExactAtEachPixelOfThePinhole) {
  const std::array<double, 8> barrel{-0.21, 0.04, 0.003, -0.002}, pincushion{0.2, 0.05};
  for (const auto& distortion : {barrel, pincushion}) {
    const RangeMap map = undistorted(seen_through(lens_of(distortion), tilted_plane));
    EXPECT_EQ(map.camera.distortion, Camera{}.distortion);
    EXPECT_EQ(map.camera.fx, 90.3);
    const int known = for_each_depth(map, [](double depth, double x, double y) {
      EXPECT_NEAR(depth, tilted_plane(x, y), kRoundingOfDepths * depth) << x << ' ' << y;
    });
    // The barrel shows more than the pinhole's image, the pincushion less.
    if (distortion == barrel) {
      EXPECT_EQ(known, map.z.size());
    } else {
      EXPECT_LT(known, map.z.size());
      EXPECT_GT(known, map.z.size() * 3 / 4);
    }
  }
}

TEST(RangeMapUndistortion, NoDepthLiesBetweenTwoSurfaces) {
  const DepthOfRay two = [](double x, double) { return x < 0.02 ? 400 : 600; };
  const RangeMap raw = seen_through(lens_of({-0.21, 0.04}), two);
  int near = 0;
  const int known = for_each_depth(undistorted(raw), [&](double depth, double, double) {
    EXPECT_LT(std::min(std::abs(depth - 400), std::abs(depth - 600)), 1e-3);
    near += depth < 500 ? 1 : 0;
  });
  EXPECT_GT(near, known / 4);
  EXPECT_GT(known - near, known / 4);
  // A column of cells at the step.
  EXPECT_GT(known, raw.z.size() - 3 * raw.z.rows());
}

TEST(RangeMapUndistortion, WithoutDistortionEachDepthStaysAndUnknownOnesStayUnknown) {
  RangeMap map = seen_through(lens_of({}), tilted_plane);
  map.z.block(20, 30, 7, 9).setConstant(std::numeric_limits<float>::quiet_NaN());
  const RangeMap same = undistorted(map);
  EXPECT_TRUE((same.z.isNaN() == map.z.isNaN()).all());
  EXPECT_LT(((same.z - map.z) / map.z).isNaN().select(0, (same.z - map.z) / map.z).abs().maxCoeff(),
            kRoundingOfDepths);
}

TEST(RangeMapUndistortion, RefusesDepthsOfAnotherSizeThanTheCamera) {
  RangeMap map = seen_through(lens_of({}), tilted_plane);
  map.camera.width = 80;
  EXPECT_THROW((void)undistorted(map), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
