// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/timed_path.h"

#include <gtest/gtest.h>

#include <limits>

#include "refusal.h"

namespace palpate::haptics {
namespace {

const std::vector<TrajectoryPoint> kCorners = {{2, {0, 0, 0}}, {4, {10, 0, 0}}, {5, {10, 5, 0}}};

TEST(TimedPath, GoesStraightBetweenItsPointsAndRestsBeyond) {
  const TimedPath path(kCorners);
  EXPECT_EQ(path.duration(), 3);
  EXPECT_EQ(path.position(-1), kCorners[0].tool);
  EXPECT_EQ(path.position(0), kCorners[0].tool);
  EXPECT_LT((path.position(0.5) - Eigen::Vector3d(2.5, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(path.position(2), kCorners[1].tool);
  EXPECT_LT((path.position(2.2) - Eigen::Vector3d(10, 1, 0)).norm(), 1e-12);
  EXPECT_EQ(path.position(9), kCorners[2].tool);
}

TEST(TimedPath, SmoothIsAtRestInItsPointsAndFastestBetween) {
  const TimedPath path(kCorners, PathShape::smooth);
  const auto speed = [&](double time) {
    constexpr double kStep = 1e-5;
    return (path.position(time + kStep) - path.position(time - kStep)).norm() / (2 * kStep);
  };
  EXPECT_NEAR(speed(1), 15.0 / 8 * 10 / 2, 1e-6);  // 15/8 of the mean: least jerk
  EXPECT_LT(speed(2), 1e-4);
  EXPECT_LT((path.position(1) - Eigen::Vector3d(5, 0, 0)).norm(), 1e-12);
}

TEST(TimedPath, RefusesWhatIsNoPath) {
  EXPECT_NE(refusal([] { return TimedPath({}); }).find("at least one is needed"),
            std::string::npos);
  EXPECT_NE(refusal([] {
              return TimedPath({{0, {0, 0, 0}}, {0, {1, 0, 0}}});
            }).find("point 1 is not later"),
            std::string::npos);
  EXPECT_NE(refusal([] {
              return TimedPath({{0, {0, std::numeric_limits<double>::quiet_NaN(), 0}}});
            }).find("point 0 is not finite"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::haptics
