// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scans/scan_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "palpate/geometry/surface_query.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

/// A cube of edge 2 about the origin: sharp edges and corners, where single normals mislead.
TriangleMesh cube() {
  TriangleMesh mesh{.vertices = Eigen::Matrix3Xd(3, 8), .triangles = Eigen::Matrix3Xi(3, 12)};
  for (int v = 0; v < 8; ++v)
    mesh.vertices.col(v) = Vector3d(v & 1, v >> 1 & 1, v >> 2) * 2 - Vector3d::Ones();
  int t = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int b = 1 << (axis + 1) % 3, c = 1 << (axis + 2) % 3, far = 1 << axis;
    mesh.triangles.col(t++) << 0, b | c, b;
    mesh.triangles.col(t++) << 0, c, b | c;
    mesh.triangles.col(t++) << far, far | b, far | b | c;
    mesh.triangles.col(t++) << far, far | b | c, far | c;
  }
  return mesh;
}

/// Signed distance to that cube.
double to_cube(const Vector3d& p) {
  const Eigen::Array3d q = p.array().abs() - 1;
  return q.max(0).matrix().norm() + std::min(q.maxCoeff(), 0.0);
}

/// Distance of a place from a scan, with its nearest triangle.
PlaceDistance tell(const ScanDistance& scan, const Vector3d& place) {
  return scan.at(place, {.triangle = SurfaceQuery(scan.mesh()).closest_point(place).at.triangle});
}

TEST(ScanDistance, IsSignedAlsoAtSharpEdgesAndCorners) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-2, 2);
  Eigen::Matrix3Xd places(3, 2000);
  for (double& x : places.reshaped()) x = uniform(random);
  const ScanDistance scan(cube(), {}, 0);
  for (const auto& place : places.colwise()) {
    const PlaceDistance there = tell(scan, place);
    EXPECT_NEAR(there.distance, to_cube(place), 1e-12);
    EXPECT_EQ(there.weight, 1);  // no border
    EXPECT_EQ(there.beyond, 0);
  }
}

TEST(ScanDistance, ContinuesBeyondTheBorderByTheOverhang) {
  const ScanDistance scan(test::flat_sheet(10, 10, 1), {}, 0.51);
  EXPECT_NEAR(tell(scan, {5, 5, 0.2}).distance, 0.2, 1e-12);
  EXPECT_NEAR(tell(scan, {10.4, 5, -0.3}).distance, -0.3, 1e-12);
  EXPECT_NEAR(tell(scan, {10.4, 5, -0.3}).beyond, 0.4, 1e-12);
  EXPECT_EQ(tell(scan, {10.6, 5, 0.1}).weight, 0);
  EXPECT_NEAR(tell(scan, {10.3, 10.4, 0.7}).distance, 0.7, 1e-12);
  EXPECT_NEAR(tell(scan, {10.3, 10.4, 0.7}).beyond, 0.5, 1e-12);
  EXPECT_NEAR(tell(scan, {10.3, 10.3, -9}).distance, -9, 1e-12);
}

TEST(ScanDistance, WeighsLessTowardsTheBorder) {
  const ScanDistance scan(test::flat_sheet(20, 20, 1), {}, 0);
  Eigen::VectorXd weight(11);
  for (int i = 0; i <= 10; ++i) weight[i] = tell(scan, {static_cast<double>(i), 10, 0.1}).weight;
  EXPECT_GT(weight[1], 0);
  for (int i = 1; i < 10; ++i) EXPECT_LE(weight[i], weight[i + 1]);
  EXPECT_LT(weight[1], 0.5);
  EXPECT_EQ(weight[10], 1);
}

TEST(ScanDistance, HasThePrecisionOfTheNearestPoint) {
  const TriangleMesh sheet = test::flat_sheet(20, 20, 1);
  const Eigen::VectorXd sigma =
      (sheet.vertices.row(0).transpose().array() < 10.5)
          .select(Eigen::VectorXd::Constant(sheet.vertices.cols(), 0.5), 0.25);
  const ScanDistance scan(sheet, sigma, 0);
  const PlaceDistance low = tell(scan, {8.3, 9.1, 1}), high = tell(scan, {12.2, 9.1, -1});
  EXPECT_NEAR(low.precision, 4, 1e-12);
  EXPECT_NEAR(high.precision, 16, 1e-12);
  EXPECT_NEAR(high.weight / low.weight, 4, 1e-12);
}

}  // namespace
}  // namespace palpate::geometry
