// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_sampling.h"

#include <gtest/gtest.h>

#include <array>
#include <map>

#include "cloud_testing.h"
#include "not_finite.h"
#include "refusal.h"
#include "told_progress.h"

namespace palpate::geometry {
namespace {

using test::Matrix3Xd;
using test::Vector3d;

/// Means of some points with coordinates of some 10 mm.
constexpr double kMeanRounding = 1e-13;

TEST(VoxelSample, HasTheMeanOfThePointsOfEachCube) {
  const double edge = 1.7;
  const Matrix3Xd points = test::random_cloud(2000, 1, {20, 15, 9}).colwise() - Vector3d(9, 9, 4);
  std::map<std::array<int, 3>, std::pair<Vector3d, int>> sums;
  for (const auto& point : points.colwise()) {
    std::array<int, 3> cube{};
    for (int axis = 0; axis < 3; ++axis)
      cube[static_cast<std::size_t>(axis)] = static_cast<int>(std::floor(point[axis] / edge));
    auto& [sum, count] = sums.try_emplace(cube, Vector3d::Zero(), 0).first->second;
    sum += point;
    ++count;
  }
  const VoxelSample sample = voxel_sample(points, edge);
  ASSERT_EQ(sample.points.cols(), static_cast<Eigen::Index>(sums.size()));
  for (const auto& mean : sample.points.colwise()) {
    const std::array<int, 3> cube = {static_cast<int>(std::floor(mean[0] / edge)),
                                     static_cast<int>(std::floor(mean[1] / edge)),
                                     static_cast<int>(std::floor(mean[2] / edge))};
    ASSERT_TRUE(sums.contains(cube));
    const auto& [sum, count] = sums[cube];
    EXPECT_LT((mean - sum / count).norm(), kMeanRounding);
  }
}

TEST(VoxelSample, TellsTheVoxelOfEachPoint) {
  Matrix3Xd points(3, 4);
  points << 0.1, 5, kNaN, 0.3, 0, 0, 0, 0, 0, 0, 0, 0;
  const VoxelSample sample = voxel_sample(points, 1);
  EXPECT_EQ(sample.voxel, (std::vector<int>{0, 1, -1, 0}));
  EXPECT_NEAR(sample.points(0, 0), 0.2, kMeanRounding);
}

TEST(VoxelSample, DoesNotDependOnTheOrderOfPoints) {
  const Matrix3Xd points = test::random_cloud(1000, 2, {10, 10, 10});
  const test::Shuffled other = test::shuffled(points, 3);
  const VoxelSample first = voxel_sample(points, 2), second = voxel_sample(other.points, 2);
  ASSERT_EQ(first.points.cols(), second.points.cols());
  for (std::size_t i = 0; i < other.order.size(); ++i) {
    const Vector3d a = first.points.col(first.voxel[static_cast<std::size_t>(other.order[i])]);
    EXPECT_LT((a - second.points.col(second.voxel[i])).norm(), kMeanRounding);
  }
}

TEST(VoxelSample, KeepsWhatCannotBeMerged) {
  EXPECT_EQ(voxel_sample(Matrix3Xd(3, 0), 1).points.cols(), 0);
  EXPECT_EQ(voxel_sample(Matrix3Xd::Constant(3, 5, kNaN), 1).points.cols(), 0);
  const Matrix3Xd one = Matrix3Xd::Constant(3, 1, 1e9);
  EXPECT_EQ(voxel_sample(one, 0.01).points, one);
}

TEST(VoxelSample, RefusesAnEdgeThatIsNotOneOrTooSmall) {
  const Matrix3Xd far = Matrix3Xd::Constant(3, 1, 1e9);
  EXPECT_EQ(refusal([&] { return voxel_sample(far, 0); }),
            "voxel_sample: edge is 0 mm; it must be > 0 and finite");
  EXPECT_EQ(refusal([&] { return voxel_sample(far, 1e-9); }),
            "voxel_sample: edge: is smaller than 2^-40 of the distance of a point; take a larger "
            "one, or remove far points first");
}

void expect_maximal_poisson_sample(const Matrix3Xd& points, double distance) {
  const std::vector<int> chosen = poisson_sample(points, distance);
  const Matrix3Xd kept = points(Eigen::all, chosen);
  ASSERT_GT(kept.cols(), 1);
  for (const auto& point : kept.colwise())
    EXPECT_GE(test::sorted_distances(kept, point)[1], distance);
  for (const auto& point : points.colwise())
    EXPECT_LT((kept.colwise() - point).colwise().norm().minCoeff(), distance);
}

TEST(PoissonSample, HasNoTwoPointsTooCloseAndNoPlaceUncovered) {
  expect_maximal_poisson_sample(test::random_cloud(3000, 5, {10, 10, 10}), 1.3);
  expect_maximal_poisson_sample(test::random_cloud(3000, 6, {10, 10, 0}), 0.4);
  expect_maximal_poisson_sample(test::sphere_cloud(2000, {1e6, 0, -1e6}, 20), 3);
}

TEST(PoissonSample, OfAGridAsWideAsTheDistanceIsTheGrid) {
  // Neighbours are exactly at the least distance, which is not too close.
  Matrix3Xd grid(3, 6 * 6 * 6);
  for (int i = 0; i < grid.cols(); ++i) grid.col(i) << i % 6, i / 6 % 6, i / 36;
  EXPECT_EQ(poisson_sample(grid, 1).size(), 216U);
}

TEST(PoissonSample, DoesNotDependOnTheOrderOfPoints) {
  const Matrix3Xd points = test::random_cloud(2000, 7, {10, 10, 10});
  const test::Shuffled other = test::shuffled(points, 8);
  EXPECT_EQ(test::in_first_order(other, poisson_sample(other.points, 1)),
            poisson_sample(points, 1));
}

TEST(PoissonSample, DoesNotDependOnTheUnitOrThePlace) {
  Matrix3Xd points = test::random_cloud(2000, 3, {20, 15, 9});
  // Multiples of a power of two, which are moved exactly.
  for (double& x : points.reshaped()) x = std::round(x * 0x1p10) * 0x1p-10;
  const double distance = 1.3;
  const std::vector<int> chosen = poisson_sample(points, distance);
  EXPECT_EQ(poisson_sample(0x1p30 * points, 0x1p30 * distance), chosen);
  EXPECT_EQ(poisson_sample(0x1p-7 * points, 0x1p-7 * distance), chosen);
  EXPECT_EQ(poisson_sample(25.4 * points, 25.4 * distance), chosen);
  EXPECT_EQ(poisson_sample(points.colwise() + Vector3d(0x1p36, -0x1p30, 0x1p20), distance), chosen);
}

TEST(PoissonSample, TakesEqualPointsOnceAndUnknownOnesNever) {
  Matrix3Xd points = Matrix3Xd::Constant(3, 1000, 2.5);
  points.col(0).setConstant(kNaN);
  points(1, 999) = kInf;
  EXPECT_EQ(poisson_sample(points, 1), std::vector<int>{1});
  EXPECT_TRUE(poisson_sample(Matrix3Xd(3, 0), 1).empty());
  Matrix3Xd zeros = Matrix3Xd::Zero(3, 2);
  zeros(0, 0) = -0.0;  // in the place of zero
  EXPECT_EQ(poisson_sample(zeros, 1), std::vector<int>{0});
}

TEST(PoissonSample, TellsItsProgress) {
  const Matrix3Xd points = test::random_cloud(120000, 2, {9, 9, 9});
  check_progress([&](const auto& progress) { (void)poisson_sample(points, 5, progress); }, 3);
}

TEST(PoissonSample, RefusesADistanceThatIsNotOneOrTooSmall) {
  Matrix3Xd far = Matrix3Xd::Zero(3, 2);
  far(2, 1) = 1e9;
  EXPECT_EQ(refusal([&] { return poisson_sample(far, kNaN); }),
            "poisson_sample: min_distance is nan mm; it must be > 0 and finite");
  EXPECT_EQ(refusal([&] { return poisson_sample(far, 1e-9); }),
            "poisson_sample: min_distance: is smaller than 2^-40 of the distance of a point; take "
            "a larger one, or remove far points first");
}

}  // namespace
}  // namespace palpate::geometry
