// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scans/scan_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

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

TEST(ScanDistance, IsSignedAlsoAtSharpEdgesAndCorners) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-2, 2);
  Eigen::Matrix3Xd places(3, 2000);
  for (double& x : places.reshaped()) x = uniform(random);
  const ScanDistance scan(cube(), {}, 0);
  const PlaceDistances there = scan.at(places);
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    EXPECT_NEAR(there.distance[i], to_cube(places.col(i)), 1e-12);
    EXPECT_EQ(there.weight[i], 1);  // no border
    EXPECT_EQ(there.beyond[i], 0);
  }
  const Eigen::VectorXd unsigned_there = scan.unsigned_at(places);
  EXPECT_LT((unsigned_there - there.distance.cwiseAbs()).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ScanDistance, ContinuesBeyondTheBorderByTheOverhang) {
  const ScanDistance scan(test::flat_sheet(10, 10, 1), {}, 0.51);
  const Eigen::Matrix3Xd places{
      {5, 10.4, 10.6, 10.3, 10.3}, {5, 5, 5, 10.4, 10.3}, {0.2, -0.3, 0.1, 0.7, -9}};
  const PlaceDistances there = scan.at(places);
  EXPECT_NEAR(there.distance[0], 0.2, 1e-12);
  EXPECT_NEAR(there.distance[1], -0.3, 1e-12);
  EXPECT_NEAR(there.beyond[1], 0.4, 1e-12);
  EXPECT_EQ(there.weight[2], 0);
  EXPECT_NEAR(there.distance[3], 0.7, 1e-12);
  EXPECT_NEAR(there.beyond[3], 0.5, 1e-12);
  EXPECT_NEAR(there.distance[4], -9, 1e-12);
}

TEST(ScanDistance, WeighsLessTowardsTheBorder) {
  const ScanDistance scan(test::flat_sheet(20, 20, 1), {}, 0);
  Eigen::Matrix3Xd places(3, 11);
  for (int i = 0; i <= 10; ++i) places.col(i) << i, 10, 0.1;
  const Eigen::VectorXd weight = scan.at(places).weight;
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
  const PlaceDistances there =
      ScanDistance(sheet, sigma, 0).at(Eigen::Matrix3Xd{{8.3, 12.2}, {9.1, 9.1}, {1, -1}});
  EXPECT_NEAR(there.precision[0], 4, 1e-12);
  EXPECT_NEAR(there.precision[1], 16, 1e-12);
  EXPECT_NEAR(there.weight[1] / there.weight[0], 4, 1e-12);
}

}  // namespace
}  // namespace palpate::geometry
