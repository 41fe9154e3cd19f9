// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Self-intersections compared with the exact predicates of CGAL's kernel, on whole numbers, where
// most triangles touch, lie in a plane or cross at edges.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Intersections_3/Triangle_3_Triangle_3.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "palpate/geometry/self_intersections.h"

namespace palpate::geometry {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// Small triangles in a grid; no two have a corner in common, and each has an area.
TriangleMesh triangles_in_a_grid(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> place(0, 25), size(-3, 3);
  std::vector<Eigen::Vector3i> corners;
  while (std::ssize(corners) < 3 * count) {
    const Eigen::Vector3i a{place(random), place(random), place(random) / 3};
    const auto near = [&] {
      return Eigen::Vector3i{a.x() + size(random), a.y() + size(random), a.z() + size(random) / 2};
    };
    const Eigen::Vector3i b = near(), c = near();
    const auto is_new = [&](const Eigen::Vector3i& p) {
      return std::ranges::find(corners, p) == corners.end();
    };
    if ((b - a).cross(c - a).isZero() || !is_new(a) || !is_new(b) || !is_new(c)) continue;
    corners.insert(corners.end(), {a, b, c});
  }
  TriangleMesh mesh;
  mesh.vertices.resize(3, 3 * count);
  mesh.triangles.resize(3, count);
  for (int i = 0; i < 3 * count; ++i)
    mesh.vertices.col(i) = corners[static_cast<std::size_t>(i)].cast<double>();
  for (int t = 0; t < count; ++t) mesh.triangles.col(t) << 3 * t, 3 * t + 1, 3 * t + 2;
  return mesh;
}

TEST(SelfIntersections, AreThoseOfCgalsExactPredicates) {
  std::size_t all = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const TriangleMesh mesh = triangles_in_a_grid(350, seed);
    std::vector<Kernel::Triangle_3> triangles;
    for (int t = 0; t < mesh.triangles.cols(); ++t) {
      const auto corner = [&](int k) {
        const Eigen::Vector3d p = mesh.vertices.col(3 * t + k);
        return Kernel::Point_3(p.x(), p.y(), p.z());
      };
      triangles.emplace_back(corner(0), corner(1), corner(2));
    }
    std::vector<int> expected;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      bool any = false;
      for (std::size_t u = 0; u < triangles.size() && !any; ++u)
        any = u != t && CGAL::do_intersect(triangles[t], triangles[u]);
      if (any) expected.push_back(static_cast<int>(t));
    }
    EXPECT_EQ(intersecting_triangles(mesh), expected);
    all += expected.size();
  }
  EXPECT_GT(all, 150U);
  EXPECT_LT(all, 1250U);
}

}  // namespace
}  // namespace palpate::geometry
