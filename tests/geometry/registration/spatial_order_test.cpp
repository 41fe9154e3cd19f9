// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "registration/spatial_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace palpate::geometry {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

std::vector<std::vector<double>> sorted_columns(const Matrix3Xd& points) {
  std::vector<std::vector<double>> columns;
  for (const auto& point : points.colwise()) columns.push_back({point.x(), point.y(), point.z()});
  std::sort(columns.begin(), columns.end());
  return columns;
}

double way_along(const Matrix3Xd& points) {
  const Eigen::Index steps = points.cols() - 1;
  return (points.rightCols(steps) - points.leftCols(steps)).colwise().norm().sum();
}

TEST(SpatialOrder, KeepsEveryPointAndBringsNeighboursTogether) {
  const Matrix3Xd points = Matrix3Xd::Random(3, 4096);
  const Matrix3Xd ordered = in_spatial_order(points);
  EXPECT_EQ(sorted_columns(ordered), sorted_columns(points));
  // Random points of a cube of edge 2 lie 1.32 apart on average; neighbours of 4096 about 0.1.
  EXPECT_GT(way_along(points) / 4095, 1.2);
  EXPECT_LT(way_along(ordered) / 4095, 0.25);
}

TEST(SpatialOrder, VisitsTheCornersOfACubeHalfByHalf) {
  Matrix3Xd corners(3, 8);
  for (int i = 0; i < 8; ++i) corners.col(7 - i) = Vector3d(i & 1, i >> 1 & 1, i >> 2);
  const Matrix3Xd ordered = in_spatial_order(corners);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(ordered.col(i), Vector3d(i & 1, i >> 1 & 1, i >> 2)) << i;
}

TEST(SpatialOrder, OfPointsWithoutExtentIsTheirOwn) {
  EXPECT_EQ(in_spatial_order(Matrix3Xd(3, 0)).cols(), 0);
  const Matrix3Xd same = Vector3d(1, 2, 3).replicate(1, 5);
  EXPECT_EQ(in_spatial_order(same), same);
}

}  // namespace
}  // namespace palpate::geometry
