// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_clusters.h"

#include <gtest/gtest.h>

#include "cloud_testing.h"
#include "not_finite.h"
#include "refusal.h"
#include "told_progress.h"

namespace palpate::geometry {
namespace {

using test::Matrix3Xd;

/// Components of the graph that joins near points, by flooding; numbered by their first point.
std::vector<int> flooded(const Matrix3Xd& points, double gap) {
  std::vector<int> component(static_cast<std::size_t>(points.cols()), -1);
  int count = 0;
  for (int seed = 0; seed < points.cols(); ++seed) {
    if (component[static_cast<std::size_t>(seed)] >= 0) continue;
    std::vector<int> border = {seed};
    component[static_cast<std::size_t>(seed)] = count;
    while (!border.empty()) {
      const int from = border.back();
      border.pop_back();
      for (int to = 0; to < points.cols(); ++to) {
        if (component[static_cast<std::size_t>(to)] >= 0 ||
            (points.col(to) - points.col(from)).norm() > gap)
          continue;
        component[static_cast<std::size_t>(to)] = count;
        border.push_back(to);
      }
    }
    ++count;
  }
  return component;
}

/// Returns true if two labels of the same points divide them alike.
bool divide_alike(const std::vector<int>& a, const std::vector<int>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if ((a[i] == a[j]) != (b[i] == b[j])) return false;
    }
  }
  return true;
}

TEST(CloudClusters, AreTheComponentsOfTheGraphOfNearPoints) {
  // About the gap at which clusters grow together, where each pair counts.
  for (const double gap : {0.5, 0.8, 0.95, 1.1}) {
    const Matrix3Xd points = test::random_cloud(1000, 1, {10, 10, 10});
    const CloudClusters clusters = cloud_clusters(points, {.max_gap = gap});
    EXPECT_TRUE(divide_alike(clusters.cluster, flooded(points, gap))) << gap;
    EXPECT_TRUE(std::is_sorted(clusters.sizes.rbegin(), clusters.sizes.rend()));
    for (int k = 0; k < static_cast<int>(clusters.sizes.size()); ++k) {
      EXPECT_EQ(std::count(clusters.cluster.begin(), clusters.cluster.end(), k),
                clusters.sizes[static_cast<std::size_t>(k)]);
    }
  }
}

TEST(CloudClusters, JoinPointsExactlyAsFarApartAsTheGap) {
  Matrix3Xd points(3, 4);
  points << 0, 2, 4, 6.5, 0, 0, 0, 0, 0, 0, 0, 0;
  const CloudClusters clusters = cloud_clusters(points, {.max_gap = 2});
  EXPECT_EQ(clusters.cluster, (std::vector<int>{0, 0, 0, 1}));
  EXPECT_EQ(clusters.sizes, (std::vector<int>{3, 1}));
}

TEST(CloudClusters, DependOnNeitherFrameNorOrder) {
  const Matrix3Xd points = test::random_cloud(800, 2, {10, 10, 10});
  const std::vector<int> first = cloud_clusters(points, {.max_gap = 0.9}).cluster;
  const test::Shuffled other = test::shuffled(points, 3);
  std::vector<int> expected;
  for (const int i : other.order) expected.push_back(first[static_cast<std::size_t>(i)]);
  EXPECT_TRUE(divide_alike(cloud_clusters(other.points, {.max_gap = 0.9}).cluster, expected));
  EXPECT_TRUE(
      divide_alike(cloud_clusters(test::some_motion() * points, {.max_gap = 0.9}).cluster, first));
}

TEST(CloudClusters, LeaveOutSmallOnesAndUnknownPoints) {
  Matrix3Xd points(3, 6);
  points << 50, 0, 1, kNaN, 2, kInf, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0;
  const CloudClusters clusters = cloud_clusters(points, {.max_gap = 1, .min_points = 2});
  EXPECT_EQ(clusters.cluster, (std::vector<int>{-1, 0, 0, -1, 0, -1}));
  EXPECT_EQ(clusters.sizes, std::vector<int>{3});
}

TEST(CloudClusters, OfEqualPointsAreOneAndQuick) {
  // Comparing all pairs would take 1e10 steps.
  const CloudClusters clusters =
      cloud_clusters(Matrix3Xd::Constant(3, 100'000, 1e9), {.max_gap = 0.01});
  EXPECT_EQ(clusters.sizes, std::vector<int>{100'000});
  EXPECT_TRUE(cloud_clusters(Matrix3Xd(3, 0), {.max_gap = 1}).sizes.empty());
}

TEST(CloudClusters, TellTheirProgress) {
  const Matrix3Xd points = test::random_cloud(100, 2, {9, 9, 9});
  check_progress(
      [&](const auto& progress) {
        (void)cloud_clusters(points, {.max_gap = 1, .progress = progress});
      },
      3);
}

TEST(CloudClusters, RefuseOptionsOutOfRange) {
  EXPECT_EQ(refusal([] { return cloud_clusters(Matrix3Xd(3, 0), {}); }),
            "CloudClusterOptions::max_gap must be given");
  EXPECT_EQ(refusal([] { return cloud_clusters(Matrix3Xd(3, 0), {.max_gap = 0}); }),
            "CloudClusterOptions::max_gap is 0 mm; it must be > 0 and finite");
  EXPECT_EQ(
      refusal([] { return cloud_clusters(Matrix3Xd(3, 0), {.max_gap = 1, .min_points = 0}); }),
      "CloudClusterOptions::min_points is 0; it must be >= 1");
}

}  // namespace
}  // namespace palpate::geometry
