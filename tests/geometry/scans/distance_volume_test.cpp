// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scans/distance_volume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "palpate/geometry/surface_query.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

/// Distances are kept in single precision.
constexpr double kVolumeRounding = 1e-6;

TEST(DistanceVolume, HoldsAllGridPointsWithinReachAndNoOthers) {
  const TriangleMesh ball = test::icosphere(3, 5);
  const Grid grid{.origin = Eigen::Vector3d(-8.1, -8.2, -8.3), .spacing = 0.7};
  const DistanceVolume volume = distances_around(ScanDistance(ball, {}, 0), grid, 1.5);
  const SurfaceQuery query(ball);
  for (int z = 0; z < 30; ++z) {
    for (int y = 0; y < 30; ++y) {
      for (int x = 0; x < 30; ++x) {
        const Eigen::Vector3d place = grid_position(grid, grid_step(x, y, z));
        const double distance = query.closest_point(place).distance;
        const auto there = volume.find(x, y, z);
        ASSERT_EQ(there.has_value(), distance <= 1.5) << x << " " << y << " " << z;
        if (!there) continue;
        // Within the ball of the corners or not: its facets are 0.02 mm inside.
        const double side = place.norm() < 4.98 ? -1 : 1;
        if (std::abs(place.norm() - 4.98) < 0.03) continue;
        EXPECT_NEAR(there->distance, side * distance, kVolumeRounding);
      }
    }
  }
}

TEST(DistanceVolume, FindsTheNearestTriangleOfRoughAndOfLargeTriangles) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.3);
  TriangleMesh rough = test::flat_sheet(30, 30, 0.63);
  for (double& z : rough.vertices.row(2)) z = noise(random);
  const TriangleMesh large = test::flat_sheet(1, 1, 19);
  for (const TriangleMesh& sheet : {rough, large}) {
    const Grid grid{.origin = Eigen::Vector3d(-7, -7, -10.3), .spacing = 1};
    const DistanceVolume volume = distances_around(ScanDistance(sheet, {}, 0), grid, 3);
    const SurfaceQuery query(sheet);
    std::vector<double> errors;
    for (int z = 0; z < 20; ++z) {
      for (int y = 9; y < 22; ++y) {
        for (int x = 9; x < 22; ++x) {
          const double distance =
              query.closest_point(grid_position(grid, grid_step(x, y, z))).distance;
          const auto there = volume.find(x, y, z);
          if (distance > 2.9) continue;
          ASSERT_TRUE(there.has_value());
          errors.push_back(std::abs(there->distance) - distance);
        }
      }
    }
    ASSERT_GT(errors.size(), 500U);
    EXPECT_GT(*std::ranges::min_element(errors), -kVolumeRounding);
    EXPECT_LT(*std::ranges::max_element(errors), 0.1);
    std::ranges::sort(errors);
    EXPECT_LT(errors[errors.size() * 99 / 100], 0.01);
  }
}

TEST(DistanceVolume, WeighsByDistanceSoThatTheNearScanDecides) {
  const Grid grid{.origin = Eigen::Vector3d(0, 0, -3), .spacing = 1};
  const DistanceVolume volume =
      distances_around(ScanDistance(test::flat_sheet(20, 20, 1), {}, 0), grid, 2);
  EXPECT_NEAR(volume.find(10, 10, 3)->weight, 1, kVolumeRounding);
  EXPECT_NEAR(volume.find(10, 10, 5)->weight, 1 / 25.0, kVolumeRounding);
}

/// A volume of single grid points.
DistanceVolume volume_of(const std::vector<GridDistance>& points) {
  DistanceVolume volume;
  for (const GridDistance& point : points) {
    const auto at = grid_index(point.key).cast<std::int64_t>().eval();
    DistanceVolume::Block& block = volume.block(block_key(at[0], at[1], at[2]));
    const std::size_t i = place_in_block(at[0], at[1], at[2]);
    block.distance[i] = static_cast<float>(point.distance);
    block.weight[i] = static_cast<float>(point.weight);
    block.beyond[i] = static_cast<float>(point.beyond);
    block.precision[i] = static_cast<float>(point.precision);
  }
  return volume;
}

TEST(DistanceVolume, CombinesByWeight) {
  DistanceVolume both =
      volume_of({{.key = 1, .distance = 1, .weight = 1, .beyond = 0.25, .precision = 2},
                 {.key = 5, .distance = 2, .weight = 3, .beyond = 0.25, .precision = 2}});
  both.add(volume_of({{.key = 5, .distance = -2, .weight = 1, .beyond = 0.125, .precision = 5},
                      {.key = 9, .distance = 4, .weight = 2, .beyond = 0, .precision = 1}}));
  EXPECT_EQ(both.find(1, 0, 0)->distance, 1);
  EXPECT_EQ(both.find(5, 0, 0)->distance, 1);  // (3 * 2 - 1 * 2) / 4
  EXPECT_EQ(both.find(5, 0, 0)->weight, 4);
  EXPECT_EQ(both.find(5, 0, 0)->beyond, 0.125);
  EXPECT_EQ(both.find(5, 0, 0)->precision, 7);
  EXPECT_EQ(both.find(9, 0, 0)->distance, 4);
  EXPECT_FALSE(both.find(2, 0, 0).has_value());
}

TEST(DistanceVolume, NamesTheGridPointsBesideTheSurfaceInOrder) {
  // A plane through the corner of eight blocks; in x, it ends at a block's border.
  std::vector<GridDistance> all;
  for (int z = 4; z < 12; ++z) {
    for (int y = 4; y < 12; ++y) {
      for (int x = 4; x < 8; ++x)
        all.push_back({.key = grid_step(x, y, z), .distance = z - 7.5, .weight = 1});
    }
  }
  const std::vector<GridDistance> near = volume_of(all).near_surface();
  ASSERT_EQ(near.size(), 2U * 8 * 4);
  EXPECT_TRUE(std::ranges::is_sorted(near, {}, &GridDistance::key));
  for (const GridDistance& point : near) EXPECT_EQ(std::abs(point.distance), 0.5);
}

}  // namespace
}  // namespace palpate::geometry
