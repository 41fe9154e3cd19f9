// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_distance.h"

#include <gtest/gtest.h>

#include "cloud_testing.h"
#include "not_finite.h"
#include "refusal.h"
#include "told_progress.h"

namespace palpate::geometry {
namespace {

using test::Matrix3Xd;
using test::Vector3d;

/// Squares of the same differences are summed in another order, and their root is taken.
constexpr double kSameSums = 1e-15;

TEST(DistancesToCloud, EqualASearchThroughAllPoints) {
  const Matrix3Xd cloud = test::random_cloud(700, 1, {30, 20, 0.5});
  const Matrix3Xd points = test::random_cloud(300, 2, {60, 25, 9});
  const Eigen::VectorXd distances = distances_to_cloud(points, cloud);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const double expected = (cloud.colwise() - points.col(i)).colwise().norm().minCoeff();
    EXPECT_NEAR(distances[i], expected, kSameSums * expected);
  }
}

TEST(DistancesToCloud, AreExactFarFromTheOrigin) {
  // Coordinates of 1e9 mm have steps of 1e-7 mm; floats would have steps of 64 mm.
  const Vector3d far(1e9, -1e9, 1e9);
  const Matrix3Xd near = test::random_cloud(200, 3, {8, 8, 8});
  const Matrix3Xd cloud = near.colwise() + far;
  const Matrix3Xd points = cloud.colwise() + Vector3d(0, 0, 0.25);
  const Eigen::VectorXd distances = distances_to_cloud(points, cloud);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const double expected = (cloud.colwise() - points.col(i)).colwise().norm().minCoeff();
    EXPECT_NEAR(distances[i], expected, kSameSums * expected);
  }
}

TEST(DistancesToCloud, AreUnknownForUnknownPointsAndIgnoreUnknownOnes) {
  Matrix3Xd cloud(3, 3);
  cloud << kNaN, 1, kInf, 0, 0, 0, 0, 0, 0;
  Matrix3Xd points(3, 2);
  points << 4, 0, 4, kNaN, 0, 0;
  const Eigen::VectorXd distances = distances_to_cloud(points, cloud);
  EXPECT_DOUBLE_EQ(distances[0], 5);
  EXPECT_TRUE(std::isnan(distances[1]));
  EXPECT_EQ(distances_to_cloud(Matrix3Xd(3, 0), cloud).size(), 0);
}

TEST(DistancesToCloud, NeedAKnownPoint) {
  const Matrix3Xd unknown = Matrix3Xd::Constant(3, 2, kNaN);
  EXPECT_EQ(refusal([&] { return distances_to_cloud(Matrix3Xd::Zero(3, 1), unknown); }),
            "distances_to_cloud: none of the 2 points of the cloud is known; at least one is "
            "needed");
  EXPECT_EQ(refusal([&] {
              return distances_to_cloud(Matrix3Xd::Zero(3, 1), Matrix3Xd::Constant(3, 1, 1e150));
            }),
            "point 0: has a coordinate beyond 1e100 mm; is the unit right?");
}

TEST(NeighbourDistances, EqualASearchThroughAllPoints) {
  const Matrix3Xd points = test::random_cloud(500, 4, {10, 10, 10});
  for (const int count : {1, 7, 40}) {
    const Eigen::VectorXd distances = neighbour_distances(points, count);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const double expected =
          test::sorted_distances(points, points.col(i))[static_cast<std::size_t>(count)];
      EXPECT_NEAR(distances[i], expected, kSameSums * expected);
    }
  }
}

TEST(NeighbourDistances, OfEqualPointsAreZeroAndQuick) {
  // A search that visits all points at the same distance would take 1e10 steps.
  const Matrix3Xd points = Matrix3Xd::Constant(3, 100'000, 7.5);
  EXPECT_EQ(neighbour_distances(points, 16), Eigen::VectorXd::Zero(points.cols()));
}

TEST(NeighbourDistances, AreInfiniteWithoutSoManyOthers) {
  EXPECT_EQ(neighbour_distances(Matrix3Xd::Zero(3, 1))[0], kInf);
  Matrix3Xd points(3, 3);
  points << 0, kNaN, 2, 0, 0, 0, 0, 0, 0;
  const Eigen::VectorXd one = neighbour_distances(points, 1), two = neighbour_distances(points, 2);
  EXPECT_EQ(one[0], 2);
  EXPECT_TRUE(std::isnan(one[1]));
  EXPECT_EQ(two[2], kInf);
  EXPECT_EQ(neighbour_distances(Matrix3Xd(3, 0)).size(), 0);
}

TEST(DistancesToCloud, TellTheirProgress) {
  const Matrix3Xd points = test::random_cloud(60000, 2, {9, 9, 9});
  check_progress(
      [&](const auto& progress) { (void)distances_to_cloud(points, points.leftCols(9), progress); },
      3);
}

TEST(NeighbourDistances, TellTheirProgress) {
  const Matrix3Xd points = test::random_cloud(60000, 2, {9, 9, 9});
  check_progress([&](const auto& progress) { (void)neighbour_distances(points, 1, progress); }, 3);
}

TEST(NeighbourDistances, RefuseACountOutOfRange) {
  EXPECT_EQ(refusal([] { return neighbour_distances(Matrix3Xd::Zero(3, 4), 0); }),
            "neighbour_distances: count is 0; it must be in [1, 1000]");
}

}  // namespace
}  // namespace palpate::geometry
