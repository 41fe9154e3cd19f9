// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/decimation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "dense_sampling.h"
#include "mesh_corpus.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/mesh_topology.h"
#include "repository.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

struct Case {
  std::string name;
  TriangleMesh mesh;
  double tolerance;  ///< [mm]
  double most;       ///< share of its triangles that may be left: the tolerance must be used
};

std::vector<Case> cases() {
  return {
      {"bumpy", test::bumpy(1500), 4, 0.6},
      {"noisy", test::bumpy(1500, 0.25), 4, 0.6},
      {"glove", test::glove(9), 1, 0.4},
      {"thin sheet", test::closed_sheet(20, 14, 6), 0.6, 0.6},
      {"thin sheet, beyond its thickness", test::closed_sheet(20, 14, 6), 1.5, 0.6},
      {"torus", test::torus(40, 20, 30, 8), 1, 0.3},
      {"hand", read_mesh(repository("meshes/hand.ply")), 0.5, 0.3},
  };
}

/// Number of pieces into which the neighbourhood of each vertex falls, found by walking from
/// triangle to triangle; in a manifold it is one everywhere.
std::map<int, int> fans(const TriangleMesh& mesh) {
  std::map<int, std::vector<int>> around;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    for (const int v : mesh.triangles.col(t)) around[v].push_back(t);
  }
  std::map<int, int> count;
  for (const auto& [v, triangles] : around) {
    std::set<int> left(triangles.begin(), triangles.end());
    while (!left.empty()) {
      ++count[v];
      std::vector<int> todo = {*left.begin()};
      left.erase(left.begin());
      while (!todo.empty()) {
        const Eigen::Vector3i here = mesh.triangles.col(todo.back());
        todo.pop_back();
        for (auto next = left.begin(); next != left.end();) {
          int shared = 0;
          for (const int w : mesh.triangles.col(*next)) shared += (here.array() == w).any() ? 1 : 0;
          if (shared < 2) {
            ++next;
            continue;
          }
          todo.push_back(*next);
          next = left.erase(next);
        }
      }
    }
  }
  return count;
}

/// Returns true if a triangle is lower than a hundredth of its longest side.
bool is_sliver(const TriangleMesh& mesh, Eigen::Index triangle) {
  const Eigen::Matrix3d corners = mesh.vertices(Eigen::all, mesh.triangles.col(triangle));
  const Eigen::Vector3d ab = corners.col(1) - corners.col(0);
  const Eigen::Vector3d ac = corners.col(2) - corners.col(0);
  const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
  return ab.cross(ac).norm() <= 0.01 * longest;
}

TEST(Decimate, KeepsToTheToleranceOnEveryMesh) {
  for (const Case& one : cases()) {
    const Decimation result = decimate(one.mesh, {.tolerance = one.tolerance});
    EXPECT_LE(result.distance, one.tolerance) << one.name;
    EXPECT_LE(static_cast<double>(result.mesh.triangles.cols()),
              one.most * static_cast<double>(one.mesh.triangles.cols()))
        << one.name;
    // Both ways, and the border with it.
    EXPECT_LE(test::sampled_distance(one.mesh, result.mesh, 1500).largest, result.distance + 1e-9)
        << one.name;
    EXPECT_LE(test::sampled_distance(result.mesh, one.mesh, 1500).largest, result.distance + 1e-9)
        << one.name;
  }
}

TEST(Decimate, KeepsAManifoldAManifold) {
  for (const Case& one : cases()) {
    const Decimation result = decimate(one.mesh, {.tolerance = one.tolerance});
    ASSERT_NO_THROW((void)test::border_edges(one.mesh)) << one.name;
    ASSERT_NO_THROW((void)test::border_edges(result.mesh)) << one.name;
    EXPECT_EQ(test::border_edges(result.mesh) == 0, test::border_edges(one.mesh) == 0) << one.name;
    const std::map<int, int> before = fans(one.mesh);
    for (const auto& [v, count] : fans(result.mesh)) {
      EXPECT_LE(count, before.at(result.source[static_cast<std::size_t>(v)])) << one.name;
    }
  }
}

TEST(Decimate, TurnsNoTriangleOver) {
  for (const Case& one : cases()) {
    const Decimation result = decimate(one.mesh, {.tolerance = one.tolerance});
    const Eigen::Matrix3Xd normals = triangle_normals(result.mesh);
    const Eigen::Matrix3Xd of_input = triangle_normals(one.mesh);
    const test::EveryTriangle triangles(one.mesh);
    int judged = 0;
    for (Eigen::Index t = 0; t < normals.cols(); ++t) {
      if (is_sliver(result.mesh, t)) continue;
      double turn = -1;  // cosine; the best of the places and of equally near triangles
      for (int k = 0; k < 4; ++k) {
        Eigen::Vector3d at = Eigen::Vector3d::Constant(1.0 / 3);
        if (k < 3) at = (at + Eigen::Vector3d::Unit(k)).eval() / 2;
        std::vector<int> nearest;
        triangles.distance(
            position(result.mesh, {.triangle = static_cast<int>(t), .barycentric = at}), 1e-9,
            &nearest);
        for (const int i : nearest) {
          const double cosine = normals.col(t).dot(of_input.col(i));
          turn = std::isnan(cosine) ? 1 : std::max(turn, cosine);
        }
      }
      EXPECT_GE(turn, 0) << one.name << ", triangle " << t;
      ++judged;
    }
    EXPECT_GE(judged, 0.9 * static_cast<double>(normals.cols())) << one.name << ": few slivers";
  }
}

TEST(Decimate, TellsItsProgressAndStopsWhereItsListenerThrows) {
  const TriangleMesh mesh = test::bumpy(1500);
  for (const DecimationOptions& goal :
       {DecimationOptions{.tolerance = 1}, DecimationOptions{.max_triangles = 300},
        DecimationOptions{.max_triangles = 3000}}) {
    std::vector<std::pair<int, int>> told;
    DecimationOptions options = goal;
    options.progress = [&](int done, int total) { told.emplace_back(done, total); };
    const Decimation result = decimate(mesh, options);
    ASSERT_EQ(told.size(), static_cast<std::size_t>(result.tries) + 1);
    EXPECT_TRUE(std::ranges::is_sorted(told));
    EXPECT_EQ(told.back().first, told.back().second);
    EXPECT_EQ(told.front().second, told.back().second);
    EXPECT_EQ(result.mesh.triangles, decimate(mesh, goal).mesh.triangles);
  }
  struct Stop {};
  int calls = 0;
  const auto stop = [&](int, int) {
    ++calls;
    throw Stop{};
  };
  EXPECT_THROW((void)decimate(mesh, {.tolerance = 1, .progress = stop}), Stop);
  EXPECT_EQ(calls, 1);
}

TEST(Decimate, TakesItsVerticesFromTheInput) {
  const TriangleMesh mesh = test::moved(
      test::glove(9), Eigen::Isometry3d(Eigen::Translation3d(1e6 + 0.1, -2e6 + 0.7, 0.3)));
  const Decimation result = decimate(mesh, {.tolerance = 1});
  ASSERT_LT(result.mesh.triangles.cols(), mesh.triangles.cols() / 2);
  ASSERT_EQ(static_cast<Eigen::Index>(result.source.size()), result.mesh.vertices.cols());
  EXPECT_TRUE(std::is_sorted(result.source.begin(), result.source.end()));
  for (Eigen::Index v = 0; v < result.mesh.vertices.cols(); ++v) {
    EXPECT_EQ(result.mesh.vertices.col(v),
              mesh.vertices.col(result.source[static_cast<std::size_t>(v)]));
  }
}

TEST(Decimate, OfASurfaceOfManyScalesEnds) {
  const TriangleMesh star = test::star_of_many_scales();
  const Decimation result = decimate(star, {.max_triangles = 300});
  const double sampled = std::max(test::sampled_distance(star, result.mesh, 1500).largest,
                                  test::sampled_distance(result.mesh, star, 1500).largest);
  EXPECT_LE(sampled, result.distance * (1 + 1e-12));
  EXPECT_LE(result.distance, 1e6);
}

TEST(Decimate, OfAFlatSheetLeavesItsFourCorners) {
  const Decimation result = decimate(test::flat_sheet(40, 30, 2), {.tolerance = 0.1});
  EXPECT_EQ(result.mesh.triangles.cols(), 2);
  EXPECT_EQ(result.source, (std::vector<int>{0, 40, 30 * 41, 31 * 41 - 1}));
  EXPECT_LT(result.distance, 1e-12);
}

TEST(Decimate, ToAToleranceTooSmallGivesBackTheInput) {
  const TriangleMesh mesh = test::bumpy(800, 0.25);
  const Decimation result = decimate(mesh, {.tolerance = 1e-6});
  EXPECT_EQ(result.mesh.vertices, mesh.vertices);
  EXPECT_EQ(result.mesh.triangles, mesh.triangles);
  EXPECT_EQ(result.distance, 0);
}

/// With two triangles beside it, a thin and a wide one that meet at their longest edge at a right
/// angle: flipping that moves the surface by 0.9 mm.
TriangleMesh beside_a_folded_sliver(const TriangleMesh& sheet) {
  TriangleMesh both = sheet;
  const auto count = static_cast<int>(sheet.vertices.cols());
  const double beside = sheet.vertices.row(0).maxCoeff() + 50;
  both.vertices.conservativeResize(3, count + 4);
  both.vertices.col(count) << beside, 0, 0;
  both.vertices.col(count + 1) << beside + 100, 0, 0;
  both.vertices.col(count + 2) << beside + 50, 0, 0.9;
  both.vertices.col(count + 3) << beside + 50, 40, 0;
  const Eigen::Index last = both.triangles.cols();
  both.triangles.conservativeResize(3, last + 2);
  both.triangles.col(last) << count, count + 1, count + 2;
  both.triangles.col(last + 1) << count + 1, count, count + 3;
  return both;
}

TEST(Decimate, LeavesASliverAloneThatCannotBeMendedWithinTheTolerance) {
  const TriangleMesh sheet = test::bumpy(1500);
  const double tolerance = 0.3;
  const auto alone = decimate(sheet, {.tolerance = tolerance});
  const auto both = decimate(beside_a_folded_sliver(sheet), {.tolerance = tolerance});
  EXPECT_LE(both.distance, tolerance);
  EXPECT_LE(both.mesh.triangles.cols(), alone.mesh.triangles.cols() + 2);
}

TEST(Decimate, ToALargerToleranceGivesFewerTriangles) {
  const TriangleMesh mesh = test::glove(9);
  Eigen::Index last = mesh.triangles.cols();
  for (const double tolerance : {0.3, 0.9, 2.7}) {
    const Eigen::Index now = decimate(mesh, {.tolerance = tolerance}).mesh.triangles.cols();
    EXPECT_LT(now, 0.8 * static_cast<double>(last)) << tolerance;
    last = now;
  }
}

TEST(Decimate, ToACountKeepsItAndSaysHowFarItIsOff) {
  const TriangleMesh mesh = test::torus(60, 30, 30, 8);
  const Decimation result = decimate(mesh, {.max_triangles = 500});
  EXPECT_LE(result.mesh.triangles.cols(), 500);
  EXPECT_GE(result.mesh.triangles.cols(), 450);
  const double sampled = std::max(test::sampled_distance(mesh, result.mesh, 1500).largest,
                                  test::sampled_distance(result.mesh, mesh, 1500).largest);
  EXPECT_LE(sampled, result.distance);
  EXPECT_GE(sampled, 0.8 * result.distance);
  EXPECT_EQ(decimate(mesh, {.max_triangles = 3600}).mesh.triangles, mesh.triangles);
}

TEST(Decimate, DoesNotDependOnTheUnitOfLength) {
  const TriangleMesh mesh = test::glove(9);
  const Decimation here = decimate(mesh, {.tolerance = 1.1});
  for (const double unit : {0x1p-20, 0x1p20}) {
    const Decimation there = decimate(test::scaled(mesh, unit), {.tolerance = 1.1 * unit});
    EXPECT_EQ(there.source, here.source);
    EXPECT_EQ(there.mesh.triangles, here.mesh.triangles);
    EXPECT_EQ(there.distance, unit * here.distance);
  }
}

TEST(Decimate, BearsAMeshThatIsNoManifold) {
  const TriangleMesh mesh = test::random_triangles(200, 30, 5);
  const Decimation result = decimate(mesh, {.tolerance = 2});
  EXPECT_LE(test::sampled_distance(mesh, result.mesh, 1500).largest, result.distance + 1e-9);
}

TEST(Decimate, RefusesBadOptionsAndMeshes) {
  const TriangleMesh mesh = test::flat_sheet(4, 4, 1);
  for (const double tolerance :
       {-1.0, 0.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW((void)decimate(mesh, {.tolerance = tolerance}), InvalidInput);
  }
  EXPECT_THROW((void)decimate(mesh, {.max_triangles = -1}), InvalidInput);
  EXPECT_THROW((void)decimate(mesh, {.max_triangles = 0}), InvalidInput);
  EXPECT_THROW((void)decimate(mesh, {}), InvalidInput);
  EXPECT_THROW((void)decimate(mesh, {.tolerance = 1, .max_triangles = 5}), InvalidInput);
  EXPECT_THROW((void)decimate({}, {.tolerance = 1}), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
