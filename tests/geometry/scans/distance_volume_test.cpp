// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scans/distance_volume.h"

#include <gtest/gtest.h>

#include <cmath>

#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

TEST(DistanceVolume, HoldsAllGridPointsWithinReachAndNoOthers) {
  const TriangleMesh ball = test::icosphere(3, 5);
  const Grid grid{.origin = Eigen::Vector3d(-8.1, -8.2, -8.3), .spacing = 0.7};
  const ScanDistance scan(ball, {}, 0);
  const auto points = distances_around(scan, grid, 1.5);
  std::size_t next = 0;
  for (int z = 0; z < 30; ++z) {
    for (int y = 0; y < 30; ++y) {
      for (int x = 0; x < 30; ++x) {
        const std::int64_t key = grid_step(x, y, z);
        const double distance = scan.at(grid_position(grid, key)).distance[0];
        if (std::abs(distance) > 1.5) continue;
        ASSERT_LT(next, points.size());
        ASSERT_EQ(points[next].key, key);
        EXPECT_EQ(points[next++].distance, distance);
      }
    }
  }
  EXPECT_EQ(next, points.size());
}

TEST(DistanceVolume, WeighsByDistanceSoThatTheNearScanDecides) {
  const Grid grid{.origin = Eigen::Vector3d(0, 0, -3), .spacing = 1};
  const auto points = distances_around(ScanDistance(test::flat_sheet(20, 20, 1), {}, 0), grid, 2);
  double at_0 = 0, at_2 = 0;
  for (const GridDistance& point : points) {
    if (point.key == grid_step(10, 10, 3)) at_0 = point.weight;
    if (point.key == grid_step(10, 10, 5)) at_2 = point.weight;
  }
  EXPECT_NEAR(at_0, 1, 1e-12);
  EXPECT_NEAR(at_2, 1 / 25.0, 1e-12);
}

TEST(DistanceVolume, CombinesByWeight) {
  const std::vector<GridDistance> a = {
      {.key = 1, .distance = 1, .weight = 1, .beyond = 0.3, .precision = 2},
      {.key = 5, .distance = 2, .weight = 3, .beyond = 0.3, .precision = 2}};
  const std::vector<GridDistance> b = {
      {.key = 5, .distance = -2, .weight = 1, .beyond = 0.1, .precision = 5},
      {.key = 9, .distance = 4, .weight = 2, .beyond = 0, .precision = 1}};
  const std::vector<GridDistance> both = combine(a, b);
  ASSERT_EQ(both.size(), 3U);
  EXPECT_EQ(both[0].distance, 1);
  EXPECT_EQ(both[1].key, 5);
  EXPECT_EQ(both[1].distance, 1);  // (3 * 2 - 1 * 2) / 4
  EXPECT_EQ(both[1].weight, 4);
  EXPECT_EQ(both[1].beyond, 0.1);
  EXPECT_EQ(both[1].precision, 7);
  EXPECT_EQ(both[2].distance, 4);
}

}  // namespace
}  // namespace palpate::geometry
