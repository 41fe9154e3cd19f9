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

/// The same triangle many times, so that no tree can tell them apart, and another.
TriangleMesh repeated_triangle(int times) {
  TriangleMesh mesh{.vertices = Eigen::Matrix3Xd(3, 6), .triangles = {}};
  mesh.vertices << 0, 1, 0, 5, 6, 5,  //
      0, 0, 1, 0, 0, 1,               //
      0, 0, 0, 2, 2, 2;
  mesh.triangles = Eigen::Vector3i(0, 1, 2).replicate(1, times + 1);
  mesh.triangles.col(times) = Eigen::Vector3i(3, 4, 5);
  return mesh;
}

/// Looks at all triangles.
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
        const Vector3d point(uniform(random), uniform(random), uniform(random) / 4);
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

}  // namespace
}  // namespace palpate::geometry
