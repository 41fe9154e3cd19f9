// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "query/surface_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

constexpr double kInf = std::numeric_limits<double>::infinity();

/// The same triangle many times, so that no tree can distinguish them, and another.
TriangleMesh repeated_triangle(int times) {
  TriangleMesh mesh{.vertices = Eigen::Matrix3Xd(3, 6), .triangles = {}};
  mesh.vertices << 0, 1, 0, 5, 6, 5,  //
      0, 0, 1, 0, 0, 1,               //
      0, 0, 0, 2, 2, 2;
  mesh.triangles = Eigen::Vector3i(0, 1, 2).replicate(1, times + 1);
  mesh.triangles.col(times) = Eigen::Vector3i(3, 4, 5);
  return mesh;
}

/// Examines all triangles.
LoneNearest exhaustive(const SurfaceTree& tree, const Vector3d& point) {
  LoneNearest found{.nearest = {}, .others = kInf};
  const TriangleMesh& mesh = tree.mesh();
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corner = [&](int k) {
      return tree.to_local(mesh.vertices.col(mesh.triangles(k, t)));
    };
    const Nearest at = nearest_on_triangle(point, {corner(0), corner(1), corner(2)});
    if (at.squared_distance < found.nearest.at.squared_distance) {
      found.others = std::sqrt(found.nearest.at.squared_distance);
      found.nearest = {.at = at, .triangle = t};
    } else {
      found.others = std::min(found.others, std::sqrt(at.squared_distance));
    }
  }
  return found;
}

TEST(SurfaceTree, FindsTheTwoNearestTrianglesWhateverTheTreeAndTheGuess) {
  const auto relief = [](double x, double y) { return std::sin(x / 3.1) * std::cos(y / 2.3); };
  for (const TriangleMesh& mesh :
       {test::random_triangles(400, 10, 3), test::height_field(20, 15, 0.7, relief),
        repeated_triangle(1000), repeated_triangle(1)}) {
    for (const TreeBuild build : {TreeBuild::thorough, TreeBuild::quick}) {
      const SurfaceTree tree(mesh, build);
      std::mt19937 random(5);
      std::uniform_real_distribution<double> uniform(-1.2, 1.2);
      int guess = -1;
      for (int i = 0; i < 50; ++i) {
        const Vector3d point{uniform(random), uniform(random), uniform(random) / 4};
        const LoneNearest expected = exhaustive(tree, point);
        const double distance = std::sqrt(expected.nearest.at.squared_distance);
        EXPECT_EQ(tree.nearest(point, kInf).triangle, expected.nearest.triangle);
        for (const double slack : {0.0, 0.01, 0.1, kInf}) {
          const LoneNearest found = tree.lone_nearest(point, guess, slack);
          EXPECT_EQ(found.nearest.triangle, expected.nearest.triangle);
          EXPECT_EQ(found.nearest.at.squared_distance, expected.nearest.at.squared_distance);
          EXPECT_EQ(found.others, std::min(expected.others, distance + slack));
          guess = found.nearest.place;  // for the next point, of which it may be far away
        }
      }
    }
  }
}

TEST(SurfaceTree, FindsTheTwoNearestTrianglesFromFarAway) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto relief = [](double x, double y) { return std::sin(x / 3.1) * std::cos(y / 2.3); };
  for (const TriangleMesh& mesh :
       {test::random_triangles(400, 10, 3), test::height_field(20, 15, 0.7, relief),
        test::flat_sheet(20, 15, 0.7), test::icosphere(3, 10), repeated_triangle(100)}) {
    const SurfaceTree tree(mesh);
    for (const double away : {1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9}) {
      for (int i = 0; i < 12; ++i) {
        Vector3d direction{normal(random), normal(random), normal(random)};
        if (i < 6) direction = (i < 3 ? 1 : -1) * Vector3d::Unit(i % 3);  // straight from before it
        const Vector3d point = away * direction.normalized() + Vector3d(0.03, -0.05, 0.02);
        const LoneNearest expected = exhaustive(tree, point);
        EXPECT_EQ(tree.nearest(point, kInf).triangle, expected.nearest.triangle);
        const double distance = std::sqrt(expected.nearest.at.squared_distance);
        for (const double slack : {0.0, 0.1, kInf}) {
          const LoneNearest found = tree.lone_nearest(point, i % 2 - 1, slack);
          EXPECT_EQ(found.nearest.triangle, expected.nearest.triangle);
          EXPECT_EQ(found.nearest.at.squared_distance, expected.nearest.at.squared_distance);
          EXPECT_EQ(found.others, std::min(expected.others, distance + slack));
        }
      }
    }
  }
}

TEST(SurfaceTree, FindsAnExtremeTriangleFromWhereAllDistancesRoundToTheSame) {
  const SurfaceTree tree(test::icosphere(4, 10));
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  const double radius = tree.scale() * 10;
  // Of triangles whose sides are at most 1 / 12 of the radius.
  const double sagitta = radius / (12 * 12 * 2);
  for (const double away : {1e10, 1e12, 1e15, 1e30, 1e150}) {
    for (int i = 0; i < 20; ++i) {
      const Vector3d direction =
          Vector3d{normal(random), normal(random), normal(random)}.normalized();
      const NearestTriangle found = tree.nearest(away * direction, kInf);
      ASSERT_GE(found.triangle, 0);
      EXPECT_NEAR(std::sqrt(found.at.squared_distance), away - radius, sagitta + 1e-15 * away);
      const Vector3d at = point_on(tree.local_corners(found.place), found.at.barycentric);
      EXPECT_NEAR(at.dot(direction), radius, sagitta);
    }
  }
  EXPECT_EQ(tree.nearest(Vector3d(1e200, 0, 0), kInf).triangle, -1);
}

}  // namespace
}  // namespace palpate::geometry
