// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/facing_share.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "not_finite.h"
#include "refusal.h"

namespace palpate::geometry {
namespace {

using ::testing::HasSubstr;

constexpr double kShareRounding = 1e-12;

// A roof along y: from its ridge at x = 0, one side falls to +x by 45 degrees, the other to -x by
// 60 degrees. `sides` vertices of spacing 1 mm along each slope.
TriangleMesh roof(int rows, int sides) {
  TriangleMesh mesh;
  const int columns = 2 * sides + 1;
  mesh.vertices.resize(3, rows * columns);
  mesh.triangles.resize(3, 2 * (rows - 1) * (columns - 1));
  Eigen::Index triangle = 0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double way = column - sides;  // along the slope
      const double angle = std::numbers::pi / (way > 0 ? 4 : 3);
      mesh.vertices.col(row * columns + column) << way * std::cos(angle), row,
          -std::abs(way) * std::sin(angle);
      if (row + 1 == rows || column + 1 == columns) continue;
      const int a = row * columns + column;
      mesh.triangles.col(triangle++) << a, a + 1, a + columns + 1;
      mesh.triangles.col(triangle++) << a, a + columns + 1, a + columns;
    }
  }
  return mesh;
}

SurfacePoint vertex_point(const TriangleMesh& mesh, int vertex) {
  return vertex_points(mesh)[static_cast<std::size_t>(vertex)];
}

TEST(FacingShares, AreThoseOfTheAreaWithinTheRadius) {
  const int rows = 21, sides = 12, columns = 2 * sides + 1;
  const TriangleMesh mesh = roof(rows, sides);
  const int ridge = rows / 2 * columns + sides;
  const auto share = [&](int vertex, const Eigen::Vector3d& direction, double radius) {
    const SurfacePoint place = vertex_point(mesh, vertex);
    return facing_shares(mesh, std::span(&place, 1), direction, radius)[0];
  };
  const Eigen::Vector3d up(0, 0, 1), right(1, 0, 0);
  EXPECT_EQ(share(ridge, up, 3), 1);
  EXPECT_EQ(share(ridge, -up, 3), 0);
  // Half of the triangles around the ridge belong to each side, as all have one area.
  EXPECT_NEAR(share(ridge, right, 0), 0.5, kShareRounding);
  EXPECT_NEAR(share(ridge, right, 3.2), 0.5, kShareRounding);
  // 4 mm from the ridge, all places within 3 mm are on one side; within 8 mm they are not.
  EXPECT_EQ(share(ridge + 4, right, 3), 1);
  EXPECT_EQ(share(ridge - 4, right, 3), 0);
  EXPECT_GT(share(ridge + 4, right, 8), 0.5);
  EXPECT_LT(share(ridge + 4, right, 8), 0.95);
  // The length of the direction and the unit of length do not matter.
  TriangleMesh large = mesh;
  large.vertices *= 1024;
  const SurfacePoint place = vertex_point(mesh, ridge + 4);
  EXPECT_EQ(facing_shares(large, std::span(&place, 1), 1e-9 * right, 8 * 1024)[0],
            share(ridge + 4, right, 8));
}

TEST(FacingShares, HardlyDependOnASliver) {
  // The corner of a square whose border has a sliver of 0.1 mm that is folded over: its angle at
  // the corner is larger than that of the square.
  TriangleMesh mesh{Eigen::Matrix3Xd(3, 5), Eigen::Matrix3Xi(3, 3)};
  mesh.vertices << 0, 10, 10, 0, -10,  //
      0, 0, 10, 10, 0.1,               //
      0, 0, 0, 0, 0;
  mesh.triangles << 0, 0, 0,  //
      1, 2, 1,                //
      2, 3, 4;
  const SurfacePoint corner{2, {1, 0, 0}};
  const Eigen::Vector3d up(0, 0, 1);
  std::swap(mesh.triangles(1, 2), mesh.triangles(2, 2));  // folded over
  ASSERT_LT(vertex_normals(mesh)(2, 0), 0);
  const double sliver = 0.5, square = 100;  // [mm^2]
  EXPECT_NEAR(facing_shares(mesh, std::span(&corner, 1), up, 3)[0], square / (square + sliver),
              kShareRounding);
  // A place within the sliver sees the square at the sliver's corners.
  const SurfacePoint within{2, {0.4, 0.3, 0.3}};
  EXPECT_GT(facing_shares(mesh, std::span(&within, 1), up, 3)[0], 0.9);
}

TEST(FacingShares, OfOneSideOfAThinPlateDoNotSeeTheOther) {
  // Two sheets 0.5 mm apart, not connected, that face away from each other.
  TriangleMesh mesh{Eigen::Matrix3Xd(3, 6), Eigen::Matrix3Xi(3, 2)};
  mesh.vertices << 0, 2, 0, 0, 2, 0,  //
      0, 0, 2, 0, 0, 2,               //
      0, 0, 0, -0.5, -0.5, -0.5;
  mesh.triangles << 0, 3,  //
      1, 5,                //
      2, 4;
  const std::vector<SurfacePoint> places = {{0, {0.3, 0.3, 0.4}}, {1, {0.3, 0.3, 0.4}}};
  Eigen::Matrix3Xd up(3, 2);
  up.colwise() = Eigen::Vector3d(0, 0, 1);
  EXPECT_EQ(facing_shares(mesh, places, up, 3), Eigen::Vector2d(1, 0));
}

TEST(FacingShares, AreNotANumberWhereNothingFaces) {
  TriangleMesh mesh{Eigen::Matrix3Xd(3, 3), Eigen::Matrix3Xi(3, 1)};
  mesh.vertices << 0, 1, 2, 0, 0, 0, 0, 0, 0;  // no area
  mesh.triangles << 0, 1, 2;
  const SurfacePoint place{0, {0.5, 0.25, 0.25}};
  EXPECT_TRUE(
      std::isnan(facing_shares(mesh, std::span(&place, 1), Eigen::Vector3d(0, 0, 1), 1)[0]));
  mesh.vertices(1, 2) = 1;
  EXPECT_TRUE(
      std::isnan(facing_shares(mesh, std::span(&place, 1), Eigen::Vector3d(kNaN, 0, 1), 1)[0]));
  EXPECT_TRUE(
      std::isnan(facing_shares(mesh, std::span(&place, 1), Eigen::Vector3d(1, 0, 0), 1)[0]));
}

TEST(FacingShares, OfWrongInputAreRefused) {
  TriangleMesh mesh{Eigen::Matrix3Xd(3, 3), Eigen::Matrix3Xi(3, 1)};
  mesh.vertices << 0, 1, 0, 0, 0, 1, 0, 0, 0;
  mesh.triangles << 0, 1, 2;
  const auto refusal_of = [&](const SurfacePoint& place, const Eigen::Matrix3Xd& directions,
                              double radius) {
    return refusal([&] { return facing_shares(mesh, std::span(&place, 1), directions, radius); });
  };
  const SurfacePoint place{0, {1, 0, 0}}, off{4, {1, 0, 0}};
  EXPECT_THAT(refusal_of(place, Eigen::Matrix3Xd(3, 2), 1), HasSubstr("1 places and 2 directions"));
  EXPECT_THAT(refusal_of(place, Eigen::Vector3d(0, 0, 1), kNaN), HasSubstr("radius"));
  EXPECT_THAT(refusal_of(off, Eigen::Vector3d(0, 0, 1), 1), HasSubstr("facing_shares()"));
}

}  // namespace
}  // namespace palpate::geometry
