// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_outliers.h"

#include <gtest/gtest.h>

#include "cloud_testing.h"
#include "not_finite.h"
#include "refusal.h"
#include "told_progress.h"

namespace palpate::geometry {
namespace {

using test::Matrix3Xd;

std::vector<int> first(int count) {
  std::vector<int> indices(static_cast<std::size_t>(count));
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

/// Points on a sphere, then a few far from it and from each other.
Matrix3Xd sphere_with_strays() {
  Matrix3Xd strays(3, 4);
  strays << 20, -18, 2, 3, 0, 3, 25, -21, 1, 0, 0, 14;
  return test::joined_points(test::sphere_cloud(1500, {1, 2, 3}, 10), strays);
}

TEST(WithoutOutliers, LeavesOutStraysAndKeepsTheSurface) {
  EXPECT_EQ(without_outliers(sphere_with_strays()), first(1500));
}

TEST(WithoutOutliers, EqualsTheDefinition) {
  const Matrix3Xd points = test::random_cloud(400, 1, {9, 9, 9});
  const OutlierOptions options{.neighbours = 5, .max_deviations = 1.2};
  Eigen::VectorXd means(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const std::vector<double> distances = test::sorted_distances(points, points.col(i));
    means[i] = std::accumulate(distances.begin(), distances.begin() + 6, 0.0) / 5;
  }
  const double deviation = std::sqrt((means.array() - means.mean()).square().sum() / 399);
  std::vector<int> expected;
  for (int i = 0; i < points.cols(); ++i) {
    if (means[i] <= means.mean() + 1.2 * deviation) expected.push_back(i);
  }
  EXPECT_LT(expected.size(), 380U);
  EXPECT_EQ(without_outliers(points, options), expected);
}

TEST(WithoutOutliers, TellsItsProgress) {
  const Matrix3Xd points = test::sphere_cloud(60000, {0, 0, 0}, 10);
  check_progress(
      [&](const auto& progress) {
        (void)without_outliers(points, {.neighbours = 2, .progress = progress});
      },
      3);
}

TEST(WithoutIsolated, TellsItsProgress) {
  const Matrix3Xd points = test::sphere_cloud(60000, {0, 0, 0}, 10);
  check_progress([&](const auto& progress) { (void)without_isolated(points, 1, 2, progress); }, 3);
}

TEST(WithoutOutliers, DependsOnNeitherFrameNorOrderNorScale) {
  const Matrix3Xd points = test::random_cloud(400, 2, {9, 9, 9});
  const std::vector<int> kept = without_outliers(points, {.max_deviations = 1});
  const test::Shuffled other = test::shuffled(points, 3);
  EXPECT_EQ(test::in_first_order(other, without_outliers(other.points, {.max_deviations = 1})),
            kept);
  EXPECT_EQ(without_outliers(test::some_motion() * points, {.max_deviations = 1}), kept);
  EXPECT_EQ(without_outliers(1e6 * points, {.max_deviations = 1}), kept);
}

TEST(WithoutOutliers, KeepsAllWhereNothingIsUnusual) {
  EXPECT_EQ(without_outliers(Matrix3Xd::Constant(3, 50, 1e9)), first(50));
  EXPECT_EQ(without_outliers(Matrix3Xd::Zero(3, 1)), first(1));
  EXPECT_TRUE(without_outliers(Matrix3Xd(3, 0)).empty());
  Matrix3Xd two = Matrix3Xd::Identity(3, 3);
  two(1, 2) = kNaN;
  EXPECT_EQ(without_outliers(two), first(2));
}

TEST(WithoutOutliers, RefusesOptionsOutOfRange) {
  EXPECT_EQ(refusal([] { return without_outliers(Matrix3Xd(3, 0), {.neighbours = 0}); }),
            "OutlierOptions::neighbours is 0; it must be in [1, 1000]");
  EXPECT_EQ(refusal([] { return without_outliers(Matrix3Xd(3, 0), {.max_deviations = kNaN}); }),
            "OutlierOptions::max_deviations is nan; it must be > 0");
}

TEST(WithoutIsolated, CountsTheOthersWithinTheRadius) {
  const Matrix3Xd points = test::random_cloud(500, 4, {10, 10, 10});
  std::vector<int> expected;
  for (int i = 0; i < points.cols(); ++i) {
    if (((points.colwise() - points.col(i)).colwise().norm().array() <= 1.1).count() - 1 >= 3)
      expected.push_back(i);
  }
  EXPECT_LT(expected.size(), 450U);
  EXPECT_GT(expected.size(), 50U);
  EXPECT_EQ(without_isolated(points, 1.1, 3), expected);
}

TEST(WithoutIsolated, LeavesOutUnknownPoints) {
  Matrix3Xd points(3, 4);
  points << 0, 1, kNaN, 40, 0, 0, 0, 0, 0, 0, 0, 0;
  EXPECT_EQ(without_isolated(points, 1, 1), first(2));  // at the radius itself: within
  EXPECT_TRUE(without_isolated(points, 1, 2).empty());
  EXPECT_EQ(refusal([&] { return without_isolated(points, -1, 1); }),
            "without_isolated: radius is -1 mm; it must be > 0 and finite");
}

}  // namespace
}  // namespace palpate::geometry
