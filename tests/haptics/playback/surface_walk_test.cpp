// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "playback/surface_walk.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <set>

#include "haptics_testing.h"
#include "test_surfaces.h"

namespace palpate::haptics {
namespace {

// Walks begin 1e-9 of a triangle beside their place.
constexpr double kWalkTolerance = 1e-7;  // [mm]

SurfacePlace corner_place(const SurfaceWalk& surface, int triangle, int corner) {
  return {triangle, surface.corner(triangle, corner)};
}

TEST(SurfaceWalk, GoesStraightAcrossAFlatSheetFromAnyCorner) {
  const geometry::TriangleMesh mesh = geometry::test::flat_sheet(10, 10, 1);
  const SurfaceWalk surface(mesh);
  const Eigen::Matrix3Xd directions = random_points(200, 1);
  for (int t = 0; t < 200; ++t) {
    for (int k = 0; k < 3; ++k) {
      const SurfacePlace from = corner_place(surface, t, k);
      Eigen::Vector3d along = directions.col(t);
      along.z() = 0;
      along.normalize();
      const Eigen::Vector3d end = from.position + 2.7 * along;
      const bool inside = end.head<2>().minCoeff() > 0.01 && end.head<2>().maxCoeff() < 9.99;
      const Walk walk = surface.walk(from, along.cross(Eigen::Vector3d::UnitZ()), along, 2.7);
      if (inside) {
        EXPECT_LT((walk.at.position - end).norm(), kWalkTolerance) << t << ' ' << k;
        EXPECT_EQ(walk.border_edge, -1);
        EXPECT_NEAR(walk.length, 2.7, kWalkTolerance);
      } else if (walk.border_edge >= 0) {
        EXPECT_LT(walk.length, 2.7 + kWalkTolerance);
        EXPECT_EQ(surface.neighbour(walk.at.triangle, walk.border_edge), -1);
      }
      const geometry::SurfacePoint point = surface.point(walk.at);
      EXPECT_LT((position(mesh, point) - walk.at.position).norm(), kWalkTolerance);
    }
  }
}

// Round a ball the section with a plane through its centre is a polygon near a great circle.
TEST(SurfaceWalk, ComesBackAfterOneRoundOfABall) {
  const geometry::TriangleMesh ball = geometry::test::icosphere(4, 10);
  const SurfaceWalk surface(ball);
  const SurfacePlace from = corner_place(surface, 7, 0);
  const Eigen::Vector3d across = from.position.cross(Eigen::Vector3d(0.3, 1, -0.2)).normalized();
  const Eigen::Vector3d along = across.cross(from.position).normalized();
  const double around = 20 * std::numbers::pi;
  const Walk walk = surface.walk(from, across, along, around);
  // Inscribed with edges of 1.4 mm: 1 - (1.4 / 20)^2 / 6 shorter.
  EXPECT_LT((walk.at.position - from.position).norm(), 2e-3 * around);
  EXPECT_NEAR(walk.at.position.dot(across), 0, kWalkTolerance);
  const Walk half = surface.walk(from, across, along, around / 2);
  EXPECT_LT((half.at.position + from.position).norm(), 2e-3 * around);
}

TEST(SurfaceWalk, EndsAfterABoundedNumberOfTriangles) {
  const SurfaceWalk surface(geometry::test::icosphere(3, 10));
  const SurfacePlace from = corner_place(surface, 0, 0);
  const Walk walk = surface.walk(from, from.position.unitOrthogonal(),
                                 from.position.cross(from.position.unitOrthogonal()), 1e9);
  EXPECT_LT(walk.length, 10 * SurfaceWalk::kMaxTriangles);
  EXPECT_GT(walk.length, 100);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector3d bad(nan, nan, nan);
  EXPECT_EQ(surface.walk(from, bad, bad, 1).at.position, from.position);
  EXPECT_EQ(surface.walk(from, bad, bad, nan).at.position, from.position);
}

TEST(SurfaceWalk, StopsWhereMoreThanTwoTrianglesMeet) {
  geometry::TriangleMesh mesh;
  mesh.vertices.resize(3, 5);
  mesh.vertices << 0, 0, 1, -1, 0,  //
      0, 1, 0, 0, 0.5,              //
      0, 0, 0, 0, 1;
  mesh.triangles.resize(3, 3);
  mesh.triangles << 0, 0, 1,  //
      2, 1, 0,                //
      1, 3, 4;
  const SurfaceWalk surface(mesh);
  const Walk walk =
      surface.walk({0, {0.2, 0.4, 0}}, Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitX(), 1);
  EXPECT_NEAR(walk.length, 0.2, kWalkTolerance);
  EXPECT_GE(walk.border_edge, 0);
}

TEST(SurfaceWalk, KnowsTheTrianglesThatAPlaceTouches) {
  const SurfaceWalk surface(geometry::test::flat_sheet(4, 4, 1));
  const auto touched = [&](const SurfacePlace& place) {
    const TouchedTriangles found = surface.touched(place, 1e-6);
    return std::set<int>(found.triangles.begin(), found.triangles.begin() + found.count);
  };
  const Eigen::Vector3d a = surface.corner(9, 0), b = surface.corner(9, 1),
                        c = surface.corner(9, 2);
  EXPECT_EQ(touched({9, (a + b + c) / 3}), std::set<int>{9});
  EXPECT_EQ(touched({9, (a + b) / 2}), (std::set<int>{9, surface.neighbour(9, 0)}));
  for (int t = 0; t < 32; ++t) {
    for (int k = 0; k < 3; ++k) {
      std::set<int> expected;  // all triangles with this corner
      for (int other = 0; other < 32; ++other) {
        for (int j = 0; j < 3; ++j) {
          if (surface.corner(other, j) == surface.corner(t, k)) expected.insert(other);
        }
      }
      EXPECT_EQ(touched(corner_place(surface, t, k)), expected) << t << ' ' << k;
    }
  }
}

}  // namespace
}  // namespace palpate::haptics
