// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scans/volume_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>

#include "palpate/geometry/mesh_defects.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/mesh_repair.h"
#include "palpate/geometry/mesh_topology.h"

namespace palpate::geometry {
namespace {

using Distance = std::function<double(const Eigen::Vector3d&)>;

/// All points of a cube of `size` points a side, about the origin.
std::vector<GridDistance> sampled(Grid& grid, int size, const Distance& distance) {
  grid.origin.setConstant(-(size - 1) / 2.0 * grid.spacing);
  std::vector<GridDistance> points;
  for (std::int64_t z = 0; z < size; ++z) {
    for (std::int64_t y = 0; y < size; ++y) {
      for (std::int64_t x = 0; x < size; ++x) {
        const std::int64_t key = grid_step(x, y, z);
        points.push_back({.key = key,
                          .distance = distance(grid_position(grid, key)),
                          .weight = 1,
                          .precision = 4});
      }
    }
  }
  return points;
}

TEST(VolumeSurface, OfABallHasItsPlaceVolumeAndSide) {
  Grid grid{.spacing = 0.5};
  const auto points = sampled(grid, 50, [](const Eigen::Vector3d& p) { return p.norm() - 10; });
  const VolumeSurface surface = zero_surface(grid, points);
  EXPECT_TRUE(find_defects(surface.mesh).empty());
  EXPECT_EQ(euler_characteristic(surface.mesh), 2);
  const Eigen::VectorXd radii = surface.mesh.vertices.colwise().norm();
  // The trilinear interpolation of a distance of curvature 1 / r is h^2 / (8 r) too large at most,
  // for each of the two directions along the surface; r is that of the cells, which reach inwards.
  EXPECT_LT((radii.array() - 10).abs().maxCoeff(), 2 * 0.25 / (8 * 9.5));
  EXPECT_NEAR(enclosed_volume(surface.mesh) / (4.0 / 3 * std::numbers::pi * 1000), 1, 0.005);
  EXPECT_LT((surface.precision.array() - 4).abs().maxCoeff(), 1e-12);
}

TEST(VolumeSurface, OfAPlaneIsExactAtAnyAngle) {
  Grid grid{.spacing = 1};
  const Eigen::Vector3d normal = Eigen::Vector3d(1, -2, 3).normalized();
  const auto points =
      sampled(grid, 12, [&](const Eigen::Vector3d& p) { return normal.dot(p) - 0.3; });
  const VolumeSurface surface = zero_surface(grid, points);
  EXPECT_TRUE(find_defects(surface.mesh).empty());
  const Eigen::VectorXd heights = surface.mesh.vertices.transpose() * normal;
  EXPECT_LT((heights.array() - 0.3).abs().maxCoeff(), 1e-12);
  const Eigen::Matrix3Xd normals = triangle_normals(surface.mesh);
  EXPECT_GT((normal.transpose() * normals).minCoeff(), 1 - 1e-9);
}

TEST(VolumeSurface, OfNoiseBecomesManifoldWithoutTurningAnything) {
  // Every ambiguous cell there is; positive on the outermost layer, so that nothing is cut off.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 20; ++trial) {
    Grid grid{.spacing = 1};
    constexpr int kSize = 10;
    const auto points = sampled(grid, kSize, [&](const Eigen::Vector3d& p) {
      const double value = uniform(random);
      return p.cwiseAbs().maxCoeff() > kSize / 2.0 - 1 ? std::abs(value) : value;
    });
    const RepairedMesh repaired = repair_mesh(zero_surface(grid, points).mesh);
    EXPECT_NO_THROW((void)connected_components(repaired.mesh));
    EXPECT_EQ(repaired.turned_triangles, 0);
  }
}

TEST(VolumeSurface, EndsWhereAPointIsUnknown) {
  Grid grid{.spacing = 1};
  auto points = sampled(grid, 12, [](const Eigen::Vector3d& p) { return p.z() - 0.2; });
  const double whole = surface_area(zero_surface(grid, points).mesh);
  const std::int64_t missing = grid_step(6, 6, 6);
  std::erase_if(points, [&](const GridDistance& point) { return point.key == missing; });
  const VolumeSurface holed = zero_surface(grid, points);
  // The four cells around that point give no vertex, so the nine squares between them and their
  // neighbours are missing.
  EXPECT_NEAR(whole - surface_area(holed.mesh), 9, 1e-9);
  EXPECT_EQ(boundary_loops(holed.mesh).size(), 2U);
}

TEST(VolumeSurface, HasNoWallBetweenTwoSidesThatScansDoNotConnect) {
  // Neighbouring points that differ by more than a distance can: far outside of one scan, far
  // inside of another.
  Grid grid{.spacing = 1};
  const auto points =
      sampled(grid, 8, [](const Eigen::Vector3d& p) { return p.z() > 0 ? 2.9 : -2.9; });
  EXPECT_EQ(zero_surface(grid, points).mesh.triangles.cols(), 0);
}

}  // namespace
}  // namespace palpate::geometry
