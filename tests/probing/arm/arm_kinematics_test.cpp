// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/arm_kinematics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "not_finite.h"

namespace palpate::probing {
namespace {

const ArmGeometry kArm;

Eigen::Vector3d random_joints(std::mt19937_64& random) {
  std::uniform_real_distribution<double> turn(-1.5, 1.5), upper(-0.6, 1.2), bend(-1.2, 1.2);
  Eigen::Vector3d joints{turn(random), upper(random), 0};
  joints[2] = joints[1] + bend(random);
  return joints;
}

/// [mm] Radius of the tip: the inverse takes the branch on the outer side of the vertical axis.
double radius(const Eigen::Vector3d& joints) {
  return kArm.upper * std::cos(joints[1]) + kArm.lower * std::sin(joints[2]);
}

TEST(ArmKinematics, InverseAndForwardGiveEachOtherBack) {
  std::mt19937_64 random(1);
  int checked = 0;
  for (int i = 0; i < 10000; ++i) {
    const Eigen::Vector3d joints = random_joints(random);
    if (radius(joints) < 5) continue;
    ++checked;
    const Eigen::Vector3d tip = tip_position(kArm, joints);
    const auto found = joints_at(kArm, tip);
    ASSERT_TRUE(found);
    EXPECT_LT((*found - joints).norm(), 1e-11);
    EXPECT_LT((tip_position(kArm, *found) - tip).norm(), 1e-9);
  }
  EXPECT_GT(checked, 5000);
}

TEST(ArmKinematics, JacobianIsTheDerivativeOfThePosition) {
  std::mt19937_64 random(2);
  constexpr double kStep = 1e-4;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d joints = random_joints(random);
    const Eigen::Matrix3d jacobian = arm_jacobian(kArm, joints);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(k);
      const Eigen::Vector3d difference =
          (tip_position(kArm, joints + d) - tip_position(kArm, joints - d)) / (2 * kStep);
      EXPECT_LT((jacobian.col(k) - difference).norm(), 1e-6 * kArm.upper);
    }
  }
}

TEST(ArmKinematics, IsThatOfTheThesisInAVerticalPlane) {
  const Eigen::Vector3d joints(0, 0.3, -0.2);
  const Eigen::Matrix3d jacobian = arm_jacobian(kArm, joints);
  // Eq 4.2, rows vertical and horizontal.
  EXPECT_DOUBLE_EQ(jacobian(1, 1), kArm.upper * std::cos(0.3));
  EXPECT_DOUBLE_EQ(jacobian(1, 2), kArm.lower * std::sin(-0.2));
  EXPECT_DOUBLE_EQ(jacobian(2, 1), -kArm.upper * std::sin(0.3));
  EXPECT_DOUBLE_EQ(jacobian(2, 2), kArm.lower * std::cos(-0.2));
}

TEST(ArmKinematics, FindsNoJointsOutOfReach) {
  EXPECT_FALSE(joints_at(kArm, {0, 0, 380}));
  EXPECT_FALSE(joints_at(kArm, {0, 0, 10}));   // nearer than the links differ
  EXPECT_FALSE(joints_at(kArm, {0, 200, 0}));  // on the axis
  EXPECT_FALSE(joints_at(kArm, {0, kNaN, 200}));
  EXPECT_TRUE(joints_at(kArm, {0, 0, 378}));
}

}  // namespace
}  // namespace palpate::probing
