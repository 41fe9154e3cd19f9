// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/snake_contour.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace palpate::sensing {
namespace {

constexpr long kSize = 120;
constexpr int kRounds = 5000;
const Eigen::Vector2d kCenter(60, 60);

/// Roughness, 2 at the walls.
Plane walls(const std::function<bool(double x, double y)>& rough) {
  Plane result(kSize, kSize);
  for (long row = 0; row < kSize; ++row) {
    for (long column = 0; column < kSize; ++column) {
      result(row, column) = rough(static_cast<double>(column), static_cast<double>(row)) ? 2 : 0;
    }
  }
  return result;
}

Labels nothing_finished() { return Labels::Constant(kSize, kSize, -1); }

double area(const Eigen::Matrix2Xd& polygon) {
  double twice = 0;
  for (long i = 0; i < polygon.cols(); ++i) {
    const long j = (i + 1) % polygon.cols();
    twice += polygon(0, i) * polygon(1, j) - polygon(1, i) * polygon(0, j);
  }
  return twice / 2;
}

bool crosses_itself(const Eigen::Matrix2Xd& polygon) {
  const auto side = [&](long a, long b, long c) {
    const Eigen::Vector2d ab = polygon.col(b) - polygon.col(a);
    const Eigen::Vector2d ac = polygon.col(c) - polygon.col(a);
    return ab.x() * ac.y() - ab.y() * ac.x();
  };
  const long count = polygon.cols();
  for (long i = 0; i < count; ++i) {
    const long i_next = (i + 1) % count;
    for (long j = i + 2; j < count; ++j) {
      const long j_next = (j + 1) % count;
      if (j_next == i) continue;
      if (side(i, i_next, j) * side(i, i_next, j_next) < 0 &&
          side(j, j_next, i) * side(j, j_next, i_next) < 0) {
        return true;
      }
    }
  }
  return false;
}

TEST(SnakeContour, GrowsUntilItFillsADisc) {
  const Plane roughness = walls([](double x, double y) { return std::hypot(x - 60, y - 60) > 40; });
  const Labels finished = nothing_finished();
  SnakeContour contour(Eigen::Vector2d(45, 66), 6, roughness, finished);
  EXPECT_TRUE(contour.grow(kRounds));
  const double radius = std::sqrt(area(contour.points()) / std::numbers::pi);
  EXPECT_GT(radius, 38);
  EXPECT_LT(radius, 41.5);
  EXPECT_FALSE(crosses_itself(contour.points()));
}

TEST(SnakeContour, RoundsTheCornersOfASquareByNoMoreThanItsRigidity) {
  const Plane roughness =
      walls([](double x, double y) { return std::max(std::abs(x - 60), std::abs(y - 60)) > 40; });
  const Labels finished = nothing_finished();
  SnakeContour contour(kCenter, 6, roughness, finished);
  EXPECT_TRUE(contour.grow(kRounds));
  // A corner rounded by a radius r loses (1 - pi / 4) r^2; the sides end within
  // a pixel and a half.
  EXPECT_GT(area(contour.points()), std::pow(77.0, 2) - 4 * 0.22 * std::pow(6.0, 2));
  EXPECT_LT(area(contour.points()), std::pow(83.0, 2));
}

TEST(SnakeContour, IsHeldByAWallWithGapsNarrowerThanItsRigidityAllows) {
  for (const double gap : {0.0, 5.0, 20.0}) {
    const Plane roughness = walls([&](double x, double y) {
      const bool frame = std::max(std::abs(x - 60), std::abs(y - 60)) > 50;
      return frame || (std::abs(x - 80) <= 1.5 && std::abs(y - 60) > gap / 2);
    });
    const Labels finished = nothing_finished();
    SnakeContour contour(Eigen::Vector2d(40, 60), 6, roughness, finished);
    EXPECT_TRUE(contour.grow(kRounds));
    const double rightmost = contour.points().row(0).maxCoeff();
    if (gap > 2 * SnakeContour::kCriticalRadius) {
      EXPECT_GT(rightmost, 105) << gap;
    } else {
      EXPECT_LT(rightmost, 85) << gap;
    }
  }
}

TEST(SnakeContour, FlowsRoundAHoleAndMeetsItselfWithoutCrossing) {
  const Plane roughness = walls([](double x, double y) {
    const double radius = std::hypot(x - 60, y - 60);
    return radius > 50 || radius < 15;
  });
  const Labels finished = nothing_finished();
  SnakeContour contour(Eigen::Vector2d(60, 28), 6, roughness, finished);
  EXPECT_TRUE(contour.grow(kRounds));
  EXPECT_FALSE(crosses_itself(contour.points()));
  const double ring = std::numbers::pi * (50 * 50 - 15 * 15);
  EXPECT_GT(area(contour.points()), 0.9 * ring);
  EXPECT_LT(area(contour.points()), 1.06 * ring);
}

TEST(SnakeContour, DoesNotEnterFinishedRegionsNorLeaveTheImage) {
  const Plane roughness = Plane::Zero(kSize, kSize);
  Labels finished = nothing_finished();
  finished.rightCols(50) = 3;
  SnakeContour contour(Eigen::Vector2d(40, 60), 6, roughness, finished);
  EXPECT_TRUE(contour.grow(kRounds));
  const Eigen::Matrix2Xd points = contour.points();
  EXPECT_LT(points.row(0).maxCoeff(), 69.5);
  EXPECT_GT(points.row(0).maxCoeff(), 67);
  EXPECT_GT(points.minCoeff(), -0.5);
  EXPECT_LT(points.row(1).maxCoeff(), kSize - 0.5);
  EXPECT_FALSE(crosses_itself(points));
}

TEST(SnakeContour, KeepsItsPointsEvenlySpaced) {
  const Plane roughness = walls([](double x, double y) { return std::hypot(x - 60, y - 60) > 40; });
  const Labels finished = nothing_finished();
  SnakeContour contour(kCenter, 6, roughness, finished);
  EXPECT_TRUE(contour.grow(kRounds));
  const Eigen::Matrix2Xd points = contour.points();
  for (long i = 0; i < points.cols(); ++i) {
    EXPECT_LT((points.col((i + 1) % points.cols()) - points.col(i)).norm(), 5);
  }
  EXPECT_LT(points.cols(), 2 * std::numbers::pi * 41 / 1.5);
}

TEST(SnakeContour, StopsAfterTheRoundsItIsGiven) {
  const Plane roughness = Plane::Zero(kSize, kSize);
  const Labels finished = nothing_finished();
  SnakeContour contour(kCenter, 6, roughness, finished);
  EXPECT_FALSE(contour.grow(10));
  const double few = area(contour.points());
  EXPECT_TRUE(contour.grow(kRounds));
  EXPECT_GT(area(contour.points()), 10 * few);
}

TEST(SnakeContour, ACircleBelowTheCriticalRadiusDoesNotGrow) {
  const Plane roughness = Plane::Zero(kSize, kSize);
  const Labels finished = nothing_finished();
  SnakeContour contour(kCenter, 0.75 * SnakeContour::kCriticalRadius, roughness, finished);
  EXPECT_TRUE(contour.grow(kRounds));
  EXPECT_LT(area(contour.points()), std::numbers::pi * std::pow(SnakeContour::kCriticalRadius, 2));
}

}  // namespace
}  // namespace palpate::sensing
