// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_measures.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "file_testing.h"
#include "mesh_corpus.h"
#include "palpate/core/error.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSumRounding = 1e-12;  // relative; sums of some 10^4 terms

Eigen::Isometry3d far_away() {
  return Eigen::Translation3d(1000.1, -700.3, 350.7) *
         Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.48, 0.6, 0.64));
}

TEST(MeshMeasures, ASphereFallsShortByTheSquareOfTheSpacing) {
  const double radius = 30.1;
  const auto relative_miss = [&](int levels) {
    const TriangleMesh mesh = test::icosphere(levels, radius);
    return Eigen::Array2d(1 - surface_area(mesh) / (4 * kPi * radius * radius),
                          1 - enclosed_volume(mesh) / (4 * kPi / 3 * std::pow(radius, 3)));
  };
  const Eigen::Array2d coarse = relative_miss(4);
  const Eigen::Array2d fine = relative_miss(5);
  EXPECT_TRUE((fine > 0).all() && (fine < 2e-3).all()) << fine;
  EXPECT_TRUE((coarse / fine - 4).abs().maxCoeff() < 0.1) << coarse / fine;
}

TEST(MeshMeasures, ATorusHasTheAreaAndVolumeOfPappus) {
  const TriangleMesh mesh = test::torus(400, 200, 30.1, 5.3);
  EXPECT_NEAR(surface_area(mesh) / (4 * kPi * kPi * 30.1 * 5.3), 1, 1e-3);
  EXPECT_NEAR(enclosed_volume(mesh) / (2 * kPi * kPi * 30.1 * 5.3 * 5.3), 1, 1e-3);
}

TEST(MeshMeasures, AClosedSheetHoldsItsOutlineTimesItsThickness) {
  EXPECT_NEAR(enclosed_volume(test::closed_sheet()) / 9600, 1, kSumRounding);
}

TEST(MeshMeasures, APlaceFarAwayChangesNothing) {
  const TriangleMesh mesh = test::glove();
  const TriangleMesh moved = test::moved(mesh, far_away());
  // Coordinates near 1000 carry 1e-13 mm, the smallest edges some 0.01 mm.
  EXPECT_NEAR(surface_area(moved) / surface_area(mesh), 1, 1e-11);
  EXPECT_NEAR(enclosed_volume(moved) / enclosed_volume(mesh), 1, 1e-11);
}

TEST(MeshMeasures, TheUnitOfLengthScalesThemExactly) {
  const TriangleMesh mesh = test::glove();
  for (const double scale : {0x1p-20, 0x1p20}) {
    EXPECT_EQ(surface_area(test::scaled(mesh, scale)), scale * scale * surface_area(mesh));
    EXPECT_EQ(enclosed_volume(test::scaled(mesh, scale)),
              scale * scale * scale * enclosed_volume(mesh));
  }
}

TEST(MeshMeasures, AMeshTurnedInsideOutHasANegativeVolume) {
  TriangleMesh mesh = test::icosphere(2, 10);
  const double volume = enclosed_volume(mesh);
  mesh.triangles.colwise().reverseInPlace();
  EXPECT_NEAR(enclosed_volume(mesh), -volume, kSumRounding * volume);
}

TEST(MeshMeasures, AnOpenMeshHasAnAreaButNoVolume) {
  const TriangleMesh sheet = test::flat_sheet(7, 4, 1.5);
  EXPECT_NEAR(surface_area(sheet), 7 * 4 * 1.5 * 1.5, kSumRounding * 63);
  EXPECT_THROWS_MESSAGE((void)enclosed_volume(sheet), InvalidInput,
                        "edge from vertex 0 to vertex 1 is at its border");
}

TEST(MeshMeasures, RefuseAVertexThatIsNotFinite) {
  TriangleMesh mesh = test::icosphere(1, 10);
  mesh.vertices(1, 7) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROWS_MESSAGE((void)surface_area(mesh), InvalidInput, "vertex 7");
  EXPECT_THROWS_MESSAGE((void)enclosed_volume(mesh), InvalidInput, "vertex 7");
}

TEST(MeshShape, OfASquareHasItsSidesAndDiagonal) {
  const MeshShape shape = mesh_shape(test::flat_sheet(1, 1, 2));
  EXPECT_EQ(shape.edges, 5);
  EXPECT_DOUBLE_EQ(shape.shortest_edge, 2);
  EXPECT_DOUBLE_EQ(shape.median_edge, 2);
  EXPECT_DOUBLE_EQ(shape.mean_edge, (8 + std::sqrt(8)) / 5);
  EXPECT_DOUBLE_EQ(shape.longest_edge, std::sqrt(8));
  EXPECT_DOUBLE_EQ(shape.smallest_angle, kPi / 4);
  EXPECT_DOUBLE_EQ(shape.median_smallest_angle, kPi / 4);
  EXPECT_DOUBLE_EQ(shape.largest_angle, kPi / 2);
}

TEST(MeshShape, OfAnIcosahedronIsEquilateralInAnyFrame) {
  const MeshShape shape = mesh_shape(test::moved(test::icosphere(0, 10), far_away()));
  EXPECT_EQ(shape.edges, 30);
  EXPECT_NEAR(shape.shortest_edge, shape.longest_edge, 1e-11);
  EXPECT_NEAR(shape.smallest_angle, kPi / 3, 1e-11);
  EXPECT_NEAR(shape.largest_angle, kPi / 3, 1e-11);
}

TEST(MeshShape, OfATriangleWithEqualCornersHasAnAngleOfZero) {
  TriangleMesh mesh = test::flat_sheet(1, 1, 2);
  mesh.vertices.col(1) = mesh.vertices.col(0);
  const MeshShape shape = mesh_shape(mesh);
  EXPECT_EQ(shape.shortest_edge, 0);
  EXPECT_EQ(shape.smallest_angle, 0);
  EXPECT_THROW((void)mesh_shape({}), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
