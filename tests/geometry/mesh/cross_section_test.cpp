// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cross_section.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "palpate/core/error.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

/// A tube around the Y axis, open at both ends.
TriangleMesh tube(double radius, double height, int around, int along) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, around * (along + 1));
  mesh.triangles.resize(3, 2 * around * along);
  for (int j = 0; j <= along; ++j) {
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      mesh.vertices.col(j * around + i) << radius * std::cos(angle), height * j / along,
          radius * std::sin(angle);
    }
  }
  int t = 0;
  for (int j = 0; j < along; ++j) {
    for (int i = 0; i < around; ++i) {
      const int a = j * around + i, b = j * around + (i + 1) % around;
      mesh.triangles.col(t++) << a, b, b + around;
      mesh.triangles.col(t++) << a, b + around, a + around;
    }
  }
  return mesh;
}

double length(const Polyline& line) {
  double sum = 0;
  for (Eigen::Index i = 1; i < line.cols(); ++i) sum += (line.col(i) - line.col(i - 1)).norm();
  return sum;
}

TEST(CrossSection, OfATubeIsOneClosedPolygonOfTheRightLength) {
  constexpr int kAround = 40;
  const auto lines = cross_section(tube(10, 30, kAround, 7), 11.3);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_TRUE(lines[0].col(0).isApprox(lines[0].col(lines[0].cols() - 1)));
  // The section runs along the planar facets, so its length is that of the regular polygon.
  EXPECT_NEAR(length(lines[0]), 2 * kAround * 10 * std::sin(std::numbers::pi / kAround), 1e-10);
  EXPECT_LT((lines[0].row(1).array() - 11.3).abs().maxCoeff(), 1e-12);
}

TEST(CrossSection, OfASlopingStripIsOneLineFromLeftToRight) {
  TriangleMesh strip;
  strip.vertices.resize(3, 6);
  strip.vertices << 4, 4, 2, 2, 0, 0,  //
      -1, 1, -1, 1, -1, 1,             //
      8, 8, 4, 4, 0, 0;
  strip.triangles.resize(3, 4);
  strip.triangles << 0, 1, 2, 3,  //
      1, 3, 3, 5,                 //
      2, 2, 4, 4;
  const auto lines = cross_section(strip, 0.25);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_DOUBLE_EQ(lines[0](0, 0), 0);
  EXPECT_DOUBLE_EQ(lines[0](0, lines[0].cols() - 1), 4);
  for (Eigen::Index i = 0; i < lines[0].cols(); ++i)
    EXPECT_DOUBLE_EQ(lines[0](2, i), 2 * lines[0](0, i));
}

TEST(CrossSection, ThroughARowOfVerticesIsStillWhole) {
  const auto lines = cross_section(tube(10, 30, 12, 3), 10);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NEAR(length(lines[0]), 2 * 12 * 10 * std::sin(std::numbers::pi / 12), 1e-10);
}

TEST(CrossSection, ATiltedPlaneCutsACircleOutOfASphere) {
  const Plane plane{.point = {3.1, -2.2, 1.7}, .normal = Eigen::Vector3d(2, 3, 6) / 7};
  const double radius = 30.1;
  const double height = plane.point.dot(plane.normal);
  const auto lines = cross_section(test::icosphere(5, radius), plane);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].col(0), lines[0].col(lines[0].cols() - 1));
  EXPECT_LT((plane.normal.transpose() * (lines[0].colwise() - plane.point)).cwiseAbs().maxCoeff(),
            1e-12);
  EXPECT_NEAR(length(lines[0]), 2 * std::numbers::pi * std::sqrt(radius * radius - height * height),
              0.1);
}

TEST(CrossSection, TurnsWithTheMesh) {
  const TriangleMesh mesh = tube(10, 30, 40, 7);
  const Eigen::Isometry3d T = Eigen::Translation3d(100.1, -70.3, 35.7) *
                              Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.48, 0.6, 0.64));
  const auto lines = cross_section(mesh, 11.3);
  const auto turned =
      cross_section(test::moved(mesh, T),
                    {.point = T * Eigen::Vector3d(3, 11.3, -8), .normal = 2.5 * T.linear().col(1)});
  ASSERT_EQ(turned.size(), 1u);
  ASSERT_EQ(turned[0].cols(), lines[0].cols());
  EXPECT_NEAR(length(turned[0]), length(lines[0]), 1e-10);
}

TEST(CrossSection, OnAPlaneAcrossXLinesRunAlongY) {
  TriangleMesh mesh = test::flat_sheet(7, 4, 1.5);
  for (const double sign : {1.0, -1.0}) {  // turned by half a circle, the vertices come from above
    mesh.vertices.topRows<2>() *= sign;
    const auto lines =
        cross_section(mesh, {.point = {sign * 2.2, 0, 0}, .normal = {sign * 2, 0, 0}});
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_NEAR(lines[0](1, 0), std::min(0.0, sign * 6), 1e-12);
    EXPECT_NEAR(lines[0](1, lines[0].cols() - 1), std::max(0.0, sign * 6), 1e-12);
    EXPECT_LT((lines[0].row(0).array() - sign * 2.2).abs().maxCoeff(), 1e-12);
  }
}

TEST(CrossSection, RefusesAPlaneWithoutNormalOrPlace) {
  const TriangleMesh mesh = test::flat_sheet(7, 4, 1.5);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)cross_section(mesh, {.normal = {0, 0, 0}}), InvalidInput);
  EXPECT_THROW((void)cross_section(mesh, {.normal = {0, nan, 0}}), InvalidInput);
  EXPECT_THROW((void)cross_section(mesh, {.point = {0, nan, 0}}), InvalidInput);
}

TEST(CrossSection, BesideTheMeshIsEmpty) {
  EXPECT_TRUE(cross_section(tube(10, 30, 12, 3), 31).empty());
}

TEST(CrossSection, RefusesAnInvalidMesh) {
  EXPECT_THROW((void)cross_section(TriangleMesh{}, 0), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
