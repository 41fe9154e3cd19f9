// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/anderson_acceleration.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

namespace palpate::probing {
namespace {

// A x = b, and the steps that an old matrix proposes for it: an identity in place of A.
const Eigen::Matrix3d kMatrix{{1.3, 0.2, -0.1}, {0.1, 0.6, 0.2}, {0, -0.3, 0.9}};
const Eigen::Vector3d kRight(1, -2, 0.5);

double error_after(int steps, AndersonAcceleration& acceleration) {
  Eigen::VectorXd x = Eigen::Vector3d::Zero();
  for (int i = 0; i < steps; ++i) {
    const Eigen::VectorXd step = acceleration.improved(kRight - kMatrix * x);
    x += step;
    acceleration.took(step);
  }
  return (kMatrix * x - kRight).norm();
}

TEST(AndersonAcceleration, SolvesALinearProblemInOneStepMoreThanItHasUnknowns) {
  // As GMRES does (Walker and Ni 2011), while each plain step leaves at least this much:
  const double rate = (Eigen::Matrix3d::Identity() - kMatrix).eigenvalues().cwiseAbs().maxCoeff();
  ASSERT_GT(rate, 0.3);
  AndersonAcceleration acceleration;
  EXPECT_LT(error_after(4, acceleration), 1e-9);
}

TEST(AndersonAcceleration, LeavesTheFirstStepAsItIs) {
  AndersonAcceleration acceleration;
  EXPECT_EQ(acceleration.improved(kRight), kRight);
}

TEST(AndersonAcceleration, ForgetsStepsWhenItIsCleared) {
  AndersonAcceleration used, fresh;
  error_after(3, used);
  used.clear();
  EXPECT_EQ(error_after(3, used), error_after(3, fresh));
}

TEST(AndersonAcceleration, SurvivesStepsThatDoNotChange) {
  AndersonAcceleration acceleration;
  for (int i = 0; i < 8; ++i) {
    const Eigen::VectorXd step = acceleration.improved(kRight);
    EXPECT_TRUE(step.allFinite());
    acceleration.took(step);
  }
}

}  // namespace
}  // namespace palpate::probing
