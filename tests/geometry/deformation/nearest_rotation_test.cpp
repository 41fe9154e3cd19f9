// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "deformation/nearest_rotation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

namespace palpate::geometry {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

const Matrix3d kTurn = AngleAxisd(2.1, Vector3d(1, -2, 3).normalized()).toRotationMatrix();

TEST(NearestRotation, IsTheTurnOfAStretchedBody) {
  const Matrix3d axes = AngleAxisd(0.7, Vector3d(3, 1, -1).normalized()).toRotationMatrix();
  const Matrix3d stretch = axes * Vector3d(0.2, 1, 7).asDiagonal() * axes.transpose();
  EXPECT_TRUE(nearest_rotation(kTurn * stretch).isApprox(kTurn, 1e-12));
}

TEST(NearestRotation, NeverReflects) {
  for (const Vector3d& stretch : {Vector3d(3, 2, -1), Vector3d(-3, -2, -1), Vector3d(1, 1, 0)}) {
    const Matrix3d turn = nearest_rotation(kTurn * stretch.asDiagonal());
    EXPECT_NEAR(turn.determinant(), 1, 1e-12);
    EXPECT_TRUE((turn * turn.transpose()).isApprox(Matrix3d::Identity(), 1e-12));
  }
}

TEST(NearestRotation, HasNoBetterOneBesideIt) {
  const Matrix3d matrix = kTurn * Vector3d(3, 2, -1).asDiagonal();
  const Matrix3d nearest = nearest_rotation(matrix);
  const double agreement = (nearest.transpose() * matrix).trace();
  for (const double angle : {-0.1, 0.01, 1.0, std::numbers::pi}) {
    for (int axis = 0; axis < 3; ++axis) {
      const Matrix3d other = AngleAxisd(angle, Vector3d::Unit(axis)) * nearest;
      EXPECT_LT((other.transpose() * matrix).trace(), agreement + 1e-12);
    }
  }
}

}  // namespace
}  // namespace palpate::geometry
