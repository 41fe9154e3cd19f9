// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/rotation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

constexpr double kTurnTolerance = 1e-14;  // some ten operations on values near 1

TEST(Rotation, ExponentialIsTheTurnAboutTheAxis) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 0.7).normalized();
  for (const double angle : {0.0, 1e-12, 1e-7, 9.9e-5, 1.01e-4, 0.3, 2.0, std::numbers::pi, 4.0}) {
    const Eigen::Matrix3d expected = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    EXPECT_LT((rotation_exp(angle * axis) - expected).norm(), kTurnTolerance) << angle;
  }
}

TEST(Rotation, LogarithmInvertsTheExponentialAlsoNearZeroAndNearAHalfTurn) {
  const Eigen::Matrix3Xd axes = random_points(20, 1);
  for (const auto& column : axes.colwise()) {
    const Eigen::Vector3d axis = column.normalized();
    for (const double angle :
         {0.0, 1e-12, 1e-7, 1e-4, 0.3, 2.0, std::numbers::pi - 1e-4, std::numbers::pi - 1e-9}) {
      const Eigen::Vector3d log = rotation_log(rotation_exp(angle * axis));
      EXPECT_LT((log - angle * axis).norm(), 1e-14 + 1e-15 * angle) << angle;
    }
    // Exactly half a turn: either sign of the axis is right.
    const Eigen::Matrix3d half = rotation_exp(std::numbers::pi * axis);
    EXPECT_LT((rotation_exp(rotation_log(half)) - half).norm(), kTurnTolerance);
  }
}

TEST(Rotation, BetweenTurnsOneDirectionIntoTheOther) {
  const Eigen::Vector3d from(0.2, -1, 3), to(2, 0.1, -0.4);
  EXPECT_LT((rotation_between(from, to) * from.normalized() - to.normalized()).norm(),
            kTurnTolerance);
  EXPECT_LT((rotation_between(from, -from) * from + from).norm(), kTurnTolerance * from.norm());
  EXPECT_TRUE(rotation_between(from, from).isIdentity(kTurnTolerance));
}

TEST(RotationBetween, IsARotationAlsoNearHalfATurn) {
  const Eigen::Vector3d from = Eigen::Vector3d::UnitZ();
  for (double angle = 1e-8; angle < 0.1; angle *= 1.1) {
    const Eigen::Vector3d to(0.6 * std::sin(angle), 0.8 * std::sin(angle), -std::cos(angle));
    const Eigen::Matrix3d rotation = rotation_between(from, to);
    EXPECT_LT((rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).norm(), 1e-14)
        << angle;
    EXPECT_LT((rotation * from - to).norm(), 1e-7) << angle;
  }
}

std::array<Eigen::Matrix3d, 3> some_frames() {
  return {rotation_exp({0.3, -0.2, 2.9}), rotation_exp({0.1, 0.4, 2.7}),
          rotation_exp({-0.2, 0.1, 3.2})};
}

TEST(BlendRotations, SolvesTheEquationOfTheMean) {
  const std::array<Eigen::Matrix3d, 3> frames = some_frames();
  const std::array weights = {0.5, 0.2, 0.3};
  const Eigen::Matrix3d mean = blend_rotations(frames, weights);
  EXPECT_LT((mean.transpose() * mean - Eigen::Matrix3d::Identity()).norm(), kTurnTolerance);
  Eigen::Vector3d balance = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    balance += weights[k] * rotation_log(mean.transpose() * frames[k]);
  }
  EXPECT_LT(balance.norm(), kTurnTolerance);
}

TEST(BlendRotations, HalfWayIsHalfTheTurn) {
  const Eigen::Matrix3d start = some_rotation();
  const Eigen::Vector3d turn(0.4, -0.9, 0.5);
  const Eigen::Matrix3d mean =
      blend_rotations(std::array<Eigen::Matrix3d, 3>{start, start * rotation_exp(turn), start},
                      std::array{0.5, 0.5, 0.0});
  EXPECT_LT((mean - start * rotation_exp(turn / 2)).norm(), kTurnTolerance);
}

TEST(BlendRotations, TurnsWithTheWorldAndWithTheLocalAxes) {
  const std::array weights = {0.5, 0.2, 0.3};
  const Eigen::Matrix3d mean = blend_rotations(some_frames(), weights);
  const Eigen::Matrix3d turn = some_rotation();
  std::array<Eigen::Matrix3d, 3> world = some_frames(), local = some_frames();
  for (Eigen::Matrix3d& frame : world) frame = turn * frame;
  for (Eigen::Matrix3d& frame : local) frame = frame * turn;
  EXPECT_LT((blend_rotations(world, weights) - turn * mean).norm(), kTurnTolerance);
  EXPECT_LT((blend_rotations(local, weights) - mean * turn).norm(), kTurnTolerance);
}

TEST(BlendRotations, DoesNotDependOnWhichComesFirst) {
  const auto [a, b, c] = some_frames();
  const Eigen::Matrix3d mean = blend_rotations(std::array{a, b, c}, std::array{0.4, 0.25, 0.35});
  EXPECT_LT((blend_rotations(std::array{c, a, b}, std::array{0.35, 0.4, 0.25}) - mean).norm(),
            kTurnTolerance);
}

TEST(BlendRotations, AtACornerIsThatFrameWhateverTheOthers) {
  const auto [a, b, c] = some_frames();
  const Eigen::Matrix3d unknown =
      Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_LT(
      (blend_rotations(std::array{unknown, b, unknown}, std::array{0.0, 1.0, 0.0}) - b).norm(),
      kTurnTolerance);
}

}  // namespace
}  // namespace palpate::haptics
