// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/stiffness_constraint.h"

#include <gtest/gtest.h>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

Eigen::VectorXd entries(const Eigen::Matrix3d& matrix) {
  Eigen::VectorXd result(6);
  result << matrix(0, 0), matrix(1, 0), matrix(1, 1), matrix(2, 0), matrix(2, 1), matrix(2, 2);
  return result;
}

Eigen::Matrix3d matrix_with(const Eigen::Vector3d& eigenvalues) {
  return some_rotation() * eigenvalues.asDiagonal() * some_rotation().transpose();
}

Eigen::VectorXd argument(const Eigen::Matrix3d& matrix) {
  Eigen::VectorXd y(12);
  y << entries(matrix), stiffness_constraint::start(matrix);
  return y;
}

TEST(StiffnessConstraint, IsKeptByDefiniteMatricesAlone) {
  for (const Eigen::Vector3d& eigenvalues :
       {Eigen::Vector3d(0.3, 1.2, 2), Eigen::Vector3d(-0.3, 1.2, 2), Eigen::Vector3d(-0.3, -1.2, 2),
        Eigen::Vector3d(-0.3, -1.2, -2)}) {
    const bool definite = eigenvalues[0] > 0;
    EXPECT_EQ(stiffness_constraint::values(argument(matrix_with(eigenvalues))).norm() < 1e-12,
              definite);
  }
}

TEST(StiffnessConstraint, DerivativesAgreeWithDifferences) {
  Eigen::VectorXd y = argument(matrix_with({0.3, 1.2, 2}));
  y += 0.1 * Eigen::VectorXd::LinSpaced(y.size(), -1, 1);  // not at a solution
  const Eigen::VectorXd multipliers =
      Eigen::VectorXd::LinSpaced(stiffness_constraint::kCount, 0.7, -1.3);
  const Eigen::MatrixXd jacobian = stiffness_constraint::jacobian(y);
  const Eigen::MatrixXd hessian = stiffness_constraint::hessian(multipliers);
  ASSERT_EQ(jacobian.rows(), stiffness_constraint::kCount);
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    const Eigen::VectorXd h = kDifferenceStep * Eigen::VectorXd::Unit(y.size(), i);
    const Eigen::VectorXd slope =
        (stiffness_constraint::values(y + h) - stiffness_constraint::values(y - h)) /
        (2 * kDifferenceStep);
    EXPECT_LT((jacobian.col(i) - slope).norm(), kDifferenceTolerance) << i;
    const Eigen::VectorXd curvature =
        (stiffness_constraint::jacobian(y + h) - stiffness_constraint::jacobian(y - h))
            .transpose() *
        multipliers / (2 * kDifferenceStep);
    EXPECT_LT((hessian.col(i) - curvature).norm(), kDifferenceTolerance) << i;
  }
}

}  // namespace
}  // namespace palpate::haptics
