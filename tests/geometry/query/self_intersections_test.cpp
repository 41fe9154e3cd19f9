// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/self_intersections.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "mesh_corpus.h"
#include "not_finite.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

TriangleMesh mesh_of(const std::vector<Vector3d>& points,
                     const std::vector<Eigen::Vector3i>& triangles) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(points.size()));
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    mesh.vertices.col(static_cast<Eigen::Index>(i)) = points[i];
  for (std::size_t i = 0; i < triangles.size(); ++i)
    mesh.triangles.col(static_cast<Eigen::Index>(i)) = triangles[i];
  return mesh;
}

/// Returns true if the edge from corner `i` of one triangle crosses the other, by solving for it.
bool crosses(const Eigen::Matrix3d& one, int i, const Eigen::Matrix3d& other) {
  Eigen::Matrix3d equations;
  equations << other.col(1) - other.col(0), other.col(2) - other.col(0),
      one.col(i) - one.col((i + 1) % 3);
  const Vector3d vwt = equations.fullPivLu().solve(one.col(i) - other.col(0));
  return vwt.minCoeff() >= 0 && vwt[0] + vwt[1] <= 1 && vwt[2] <= 1;
}

std::vector<int> found_by_trying_all(const TriangleMesh& mesh) {
  std::vector<int> found;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Matrix3d one = mesh.vertices(Eigen::all, mesh.triangles.col(t));
    bool any = false;
    for (int u = 0; u < mesh.triangles.cols() && !any; ++u) {
      const Eigen::Matrix3d other = mesh.vertices(Eigen::all, mesh.triangles.col(u));
      for (int k = 0; k < 3 && u != t; ++k)
        any = any || crosses(one, k, other) || crosses(other, k, one);
    }
    if (any) found.push_back(t);
  }
  return found;
}

TEST(SelfIntersections, AreTheTrianglesOfWhichAnEdgeCrossesAnother) {
  for (const unsigned seed : {1U, 2U}) {
    TriangleMesh mesh = test::random_triangles(120, 30, seed);
    for (Eigen::Index t = 0; t < 120; ++t) {
      const Vector3d middle = mesh.vertices.middleCols<3>(3 * t).rowwise().mean();
      mesh.vertices.middleCols<3>(3 * t) =
          (2.5 * mesh.vertices.middleCols<3>(3 * t)).colwise() - 1.5 * middle;
    }
    const std::vector<int> expected = found_by_trying_all(mesh);
    EXPECT_GT(expected.size(), 10U);
    EXPECT_LT(expected.size(), 110U);
    EXPECT_EQ(intersecting_triangles(mesh), expected);
  }
}

TEST(SelfIntersections, AreNoneOfSurfacesThatOnlyMeetAtTheirEdges) {
  EXPECT_TRUE(intersecting_triangles(test::icosphere(3, 10.7)).empty());
  EXPECT_TRUE(intersecting_triangles(test::flat_sheet(30, 20, 0.7)).empty());
  EXPECT_TRUE(intersecting_triangles(test::bumpy(5000, 0.25)).empty());
  EXPECT_TRUE(intersecting_triangles(test::torus(40, 12, 50, 3)).empty());
  EXPECT_TRUE(intersecting_triangles(test::closed_sheet()).empty());
}

/// A ring of triangles where two spheres pass through each other, and none elsewhere.
TEST(SelfIntersections, LieWhereTwoSpheresPassThroughEachOther) {
  const double radius = 10.7, apart = 12.3;
  TriangleMesh mesh = test::icosphere(3, radius);
  const Eigen::Index vertices = mesh.vertices.cols(), triangles = mesh.triangles.cols();
  mesh.vertices.conservativeResize(3, 2 * vertices);
  mesh.vertices.rightCols(vertices) =
      mesh.vertices.leftCols(vertices).colwise() + Vector3d(apart, 0, 0);
  mesh.triangles.conservativeResize(3, 2 * triangles);
  mesh.triangles.rightCols(triangles) =
      mesh.triangles.leftCols(triangles).array() + static_cast<int>(vertices);
  const std::vector<int> found = intersecting_triangles(mesh);
  const double longest = 0.2 * radius;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    const double x = mesh.vertices(Eigen::all, mesh.triangles.col(t)).row(0).mean();
    if (std::ranges::binary_search(found, t)) {
      EXPECT_NEAR(x, apart / 2, longest);
    }
  }
  // Each ring is a circle that every triangle follows for at most its longest side.
  const double ring = 2 * 3.14159 * std::sqrt(radius * radius - apart * apart / 4);
  EXPECT_GT(static_cast<double>(found.size()), 2 * ring / longest);
}

struct Pair {
  const char* name;
  std::vector<Vector3d> points;  ///< of the first triangle, and those that the second adds
  Eigen::Vector3i second;
  bool intersect;
};

const std::vector<Pair>& pairs() {
  static const std::vector<Vector3d> first = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const auto with = [](std::vector<Vector3d> more) {
    more.insert(more.begin(), first.begin(), first.end());
    return more;
  };
  static const std::vector<Pair> all = {
      {"crossing", with({{1, 1, -1}, {1, 1, 1}, {9, 9, 1}}), {3, 4, 5}, true},
      {"beside", with({{3, 3, -1}, {3, 3, 1}, {9, 9, 1}}), {3, 4, 5}, false},
      {"above", with({{1, 1, 1}, {1, 2, 1}, {2, 1, 2}}), {3, 4, 5}, false},
      {"vertex on the face", with({{1, 1, 0}, {1, 2, 1}, {2, 1, 2}}), {3, 4, 5}, true},
      {"vertex on an edge", with({{2, 2, 0}, {3, 3, 1}, {3, 4, 2}}), {3, 4, 5}, true},
      {"edges crossing", with({{2, -1, -1}, {2, 1, 1}, {2, -5, 3}}), {3, 4, 5}, true},
      {"overlapping in a plane", with({{1, 1, 0}, {9, 1, 0}, {9, 2, 0}}), {3, 4, 5}, true},
      {"inside in a plane", with({{1, 1, 0}, {1.5, 1, 0}, {1, 1.5, 0}}), {3, 4, 5}, true},
      {"star in a plane", with({{-1, 2, 0}, {3, 2.5, 0}, {2, -1, 0}}), {3, 4, 5}, true},
      {"apart in a plane", with({{3, 3, 0}, {9, 3, 0}, {9, 9, 0}}), {3, 4, 5}, false},
      {"sharing a vertex", with({{-1, -1, 0}, {-1, -1, 1}}), {0, 3, 4}, false},
      {"sharing a vertex and crossing", with({{1, 1, -1}, {1, 1, 1}}), {0, 3, 4}, true},
      {"sharing a vertex, edge on edge", with({{2, 0, 0}, {2, 0, 3}}), {0, 3, 4}, true},
      {"sharing a vertex, edge longer", with({{9, 0, 0}, {2, 0, 3}}), {0, 3, 4}, true},
      {"sharing a vertex in a plane", with({{-1, 0, 0}, {0, -1, 0}}), {0, 3, 4}, false},
      {"sharing a vertex, overlapping", with({{3, 1, 0}, {9, 4, 0}}), {0, 3, 4}, true},
      {"sharing a place", with({{0, 0, 0}, {-1, -1, 0}, {-1, -1, 1}}), {3, 4, 5}, false},
      {"neighbours", with({{4, 4, 0}}), {1, 3, 2}, false},
      {"neighbours with a crease", with({{1, 1, 1e-60}}), {1, 0, 3}, false},
      {"folded onto a neighbour", with({{1, 1, 0}}), {1, 0, 3}, true},
      {"folded beyond a neighbour", with({{9, 9, 0}}), {1, 0, 3}, true},
  };
  return all;
}

TEST(SelfIntersections, OfTwoTrianglesAreDecidedExactly) {
  for (const Pair& pair : pairs()) {
    for (int turn = 0; turn < 3; ++turn) {
      const Eigen::Vector3i& s = pair.second;
      const Eigen::Vector3i second(s[turn], s[(turn + 1) % 3], s[(turn + 2) % 3]);
      TriangleMesh mesh = mesh_of(pair.points, {{0, 1, 2}, second});
      const std::vector<int> expected = pair.intersect ? std::vector{0, 1} : std::vector<int>{};
      for (const double scale : {1.0, 0x1p40, 0x1p-40})
        EXPECT_EQ(intersecting_triangles(test::scaled(mesh, scale)), expected) << pair.name;
      mesh.vertices = mesh.vertices({2, 0, 1}, Eigen::all).eval();
      mesh.triangles = mesh.triangles.rowwise().reverse().eval();
      EXPECT_EQ(intersecting_triangles(mesh), expected) << pair.name;
      // Exact in double.
      if (std::string(pair.name) == "neighbours with a crease") continue;
      mesh.vertices.colwise() += Vector3d(1e9, -3e9, 7e9);
      EXPECT_EQ(intersecting_triangles(mesh), expected) << pair.name;
    }
  }
}

TEST(SelfIntersections, OfBadMeshesLeaveOutWhatHasNoArea) {
  const TriangleMesh crossing = mesh_of(
      {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {9, 9, 1}, {1, 1, 0}, {kNaN, 0, 0}},
      {{3, 4, 6}, {0, 1, 7}, {0, 1, 99}, {-1, 1, 2}, {0, 0, 2}, {3, 4, 5}, {0, 1, 2}, {2, 0, 1}});
  EXPECT_EQ(intersecting_triangles(crossing), (std::vector{5, 6, 7}));
  EXPECT_TRUE(intersecting_triangles(TriangleMesh{}).empty());
  TriangleMesh nothing = crossing;
  nothing.vertices.setConstant(kInf);
  EXPECT_TRUE(intersecting_triangles(nothing).empty());
}

TEST(SelfIntersections, AreListedAfterTheOtherDefects) {
  TriangleMesh mesh = test::random_triangles(120, 30, 1);
  const std::vector<int> found = intersecting_triangles(mesh);
  mesh.vertices.conservativeResize(3, mesh.vertices.cols() + 1);
  mesh.vertices.rightCols(1).setConstant(kNaN);
  const std::vector<MeshDefect> plain = find_defects(mesh), all = find_all_defects(mesh);
  ASSERT_EQ(all.size(), plain.size() + 1);
  EXPECT_EQ(all.front().kind, DefectKind::infinite_vertex);
  EXPECT_EQ(all.back().kind, DefectKind::triangle_intersecting);
  EXPECT_EQ(all.back().elements, found);
  EXPECT_EQ(describe({DefectKind::triangle_intersecting, {3, 8}}),
            "triangles that intersect others: 2 (3, 8)");
  EXPECT_STREQ(to_string(DefectKind::triangle_intersecting), "triangle_intersecting");
}

}  // namespace
}  // namespace palpate::geometry
