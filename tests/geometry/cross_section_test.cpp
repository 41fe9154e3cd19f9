// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cross_section.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "palpate/error.h"

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

TEST(CrossSection, BesideTheMeshIsEmpty) {
  EXPECT_TRUE(cross_section(tube(10, 30, 12, 3), 31).empty());
}

TEST(CrossSection, RefusesAnInvalidMesh) {
  EXPECT_THROW((void)cross_section(TriangleMesh{}, 0), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
