// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/farthest_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/geometry/geodesic_distance.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using test::flat_sheet;
using test::height_field;

std::vector<int> all_vertices(const TriangleMesh& mesh) {
  std::vector<int> all(static_cast<std::size_t>(mesh.vertices.cols()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// Against straight distances, which are those along a plane. Fast marching is exact there.
TEST(FarthestPoints, ArePackedAndCoverAPlaneAtEachPrefix) {
  const TriangleMesh mesh = flat_sheet(40, 30, 1.3);
  const std::vector<int> candidates = all_vertices(mesh);
  const FarthestPoints found = farthest_points(mesh, candidates, {.spacing = 7});
  ASSERT_EQ(found.cover.size(), found.vertices.size());
  constexpr double kRounding = 1e-9;  // [mm]
  Eigen::VectorXd nearest = Eigen::VectorXd::Constant(mesh.vertices.cols(), 1e9);
  for (std::size_t k = 0; k < found.vertices.size(); ++k) {
    const int v = found.vertices[k];
    if (k > 0) {
      EXPECT_NEAR(nearest[v], found.cover[k - 1], kRounding);
      EXPECT_GE(nearest[v], 7 - kRounding);
    }
    nearest = nearest.cwiseMin(
        (mesh.vertices.colwise() - mesh.vertices.col(v)).colwise().norm().transpose());
    EXPECT_NEAR(found.cover[k], nearest.maxCoeff(), kRounding);
  }
  EXPECT_LT(found.cover.back(), 7);
}

TEST(FarthestPoints, AddingSourcesGivesTheDistancesOfAllAtOnce) {
  const TriangleMesh mesh = height_field(
      60, 60, 1, [](double x, double y) { return 6 * std::sin(x / 9) * std::cos(y / 7); });
  const FarthestPoints found = farthest_points(mesh, all_vertices(mesh), {.spacing = 5});
  const std::vector<SurfacePoint> places = vertex_points(mesh);
  std::vector<SurfacePoint> sources;
  for (const int v : found.vertices) sources.push_back(places[static_cast<std::size_t>(v)]);
  EXPECT_GT(sources.size(), 100U);
  // In another order waves end at other vertices beside their cells: 0.3 %.
  EXPECT_NEAR(geodesic_distance(mesh, sources).distance.maxCoeff(), found.cover.back(), 0.02);
}

TEST(FarthestPoints, AreCandidatesOnlyAndNoMoreThanAskedFor) {
  const TriangleMesh mesh = flat_sheet(20, 20, 1);
  std::vector<int> candidates;
  for (int v = 0; v < mesh.vertices.cols(); ++v) {
    if (mesh.vertices(0, v) < 9) candidates.push_back(v);
  }
  const FarthestPoints found = farthest_points(mesh, candidates, {.spacing = 2, .count = 12});
  EXPECT_EQ(found.vertices.size(), 12U);
  for (const int v : found.vertices) EXPECT_LT(mesh.vertices(0, v), 9);
  const FarthestPoints coarse = farthest_points(mesh, candidates, {.spacing = 2, .count = 5});
  EXPECT_TRUE(std::equal(coarse.vertices.begin(), coarse.vertices.end(), found.vertices.begin()));
}

TEST(FarthestPoints, AreOnEachPartOfTheSurface) {
  TriangleMesh mesh = flat_sheet(4, 4, 1);
  const TriangleMesh other = mesh;
  const auto first = mesh.vertices.cols();
  mesh.vertices.conservativeResize(3, 2 * first);
  mesh.vertices.rightCols(first) = other.vertices.colwise() + Eigen::Vector3d(100, 0, 0);
  mesh.triangles.conservativeResize(3, 2 * other.triangles.cols());
  mesh.triangles.rightCols(other.triangles.cols()) =
      other.triangles.array() + static_cast<int>(first);
  const FarthestPoints found = farthest_points(mesh, all_vertices(mesh), {.spacing = 50});
  ASSERT_EQ(found.vertices.size(), 2U);
  EXPECT_EQ(found.cover[0], std::numeric_limits<double>::infinity());
  EXPECT_NE(found.vertices[0] < first, found.vertices[1] < first);
}

TEST(FarthestPoints, TakesEachVertexOnceHoweverSmallTheSpacingIs) {
  TriangleMesh rough = test::icosphere(3, 30);  // where distances at sources are not exactly 0
  const FarthestPoints found = farthest_points(rough, all_vertices(rough), {.spacing = 1e-300});
  std::vector<int> vertices = found.vertices;
  std::ranges::sort(vertices);
  EXPECT_EQ(vertices, all_vertices(rough));
  EXPECT_EQ(found.cover.size(), vertices.size());
  EXPECT_EQ(found.cover.back(), 0);
}

TEST(FarthestPoints, RefusesWhatIsNoSpacingOrNoVertex) {
  const TriangleMesh mesh = flat_sheet(4, 4, 1);
  const std::vector<int> wrong{3, 25};
  EXPECT_THROW((void)farthest_points(mesh, wrong, {.spacing = 1}), InvalidInput);
  EXPECT_THROW((void)farthest_points(mesh, all_vertices(mesh), {}), InvalidInput);
  EXPECT_THROW((void)farthest_points(mesh, all_vertices(mesh), {.spacing = 1, .count = 0}),
               InvalidInput);
  EXPECT_TRUE(farthest_points(mesh, {}, {.spacing = 1}).vertices.empty());
}

}  // namespace
}  // namespace palpate::geometry
