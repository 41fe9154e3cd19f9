// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/stiffness_constraint.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

// Central differences with step 1e-5 of functions of order 1 to 10.
constexpr double kStep = 1e-5;
constexpr double kTolerance = 1e-7;

Eigen::VectorXd entries(const Eigen::Matrix3d& matrix) {
  Eigen::VectorXd result(6);
  result << matrix(0, 0), matrix(1, 0), matrix(1, 1), matrix(2, 0), matrix(2, 1), matrix(2, 2);
  return result;
}

Eigen::Matrix3d matrix_with(const Eigen::Vector3d& eigenvalues) {
  return some_rotation() * eigenvalues.asDiagonal() * some_rotation().transpose();
}

Eigen::VectorXd argument(const StiffnessConstraint& constraint, const Eigen::Matrix3d& matrix) {
  const Eigen::VectorXd slacks = constraint.start(matrix);
  Eigen::VectorXd y(6 + slacks.size());
  y << entries(matrix), slacks;
  return y;
}

TEST(StiffnessConstraint, IsKeptByDefiniteMatricesAlone) {
  for (const Eigen::Vector3d& eigenvalues :
       {Eigen::Vector3d(0.3, 1.2, 2), Eigen::Vector3d(-0.3, 1.2, 2), Eigen::Vector3d(-0.3, -1.2, 2),
        Eigen::Vector3d(-0.3, -1.2, -2)}) {
    const Eigen::Matrix3d matrix = matrix_with(eigenvalues);
    const bool definite = eigenvalues[0] > 0;
    for (const StiffnessForm form : {StiffnessForm::eigenvalue, StiffnessForm::minors}) {
      const StiffnessConstraint constraint{form};
      EXPECT_EQ(constraint.values(argument(constraint, matrix)).minCoeff() >= 0, definite);
    }
    const StiffnessConstraint factor{StiffnessForm::factor};
    EXPECT_EQ(factor.values(argument(factor, matrix)).norm() < 1e-12, definite);
  }
}

TEST(StiffnessConstraint, HasTheDeterminantAmongItsMinors) {
  const Eigen::Matrix3d matrix = matrix_with({0.3, -1.2, 2});
  EXPECT_NEAR(StiffnessConstraint{StiffnessForm::minors}.values(entries(matrix))[6],
              matrix.determinant(), 1e-12);
}

TEST(StiffnessConstraint, DerivativesAgreeWithDifferences) {
  for (const StiffnessForm form :
       {StiffnessForm::factor, StiffnessForm::eigenvalue, StiffnessForm::minors}) {
    const StiffnessConstraint constraint{form};
    Eigen::VectorXd y = argument(constraint, matrix_with({0.3, 1.2, 2}));
    y += 0.1 * Eigen::VectorXd::LinSpaced(y.size(), -1, 1);  // factor: not at a solution
    const Eigen::VectorXd multipliers = Eigen::VectorXd::LinSpaced(constraint.count(), 0.7, -1.3);
    const Eigen::MatrixXd jacobian = constraint.jacobian(y);
    const Eigen::MatrixXd hessian = constraint.hessian(y, multipliers);
    ASSERT_EQ(jacobian.rows(), constraint.count());
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      const Eigen::VectorXd h = kStep * Eigen::VectorXd::Unit(y.size(), i);
      const Eigen::VectorXd slope =
          (constraint.values(y + h) - constraint.values(y - h)) / (2 * kStep);
      EXPECT_LT((jacobian.col(i) - slope).norm(), kTolerance) << i;
      const Eigen::VectorXd curvature =
          (constraint.jacobian(y + h) - constraint.jacobian(y - h)).transpose() * multipliers /
          (2 * kStep);
      EXPECT_LT((hessian.col(i) - curvature).norm(), kTolerance) << i;
    }
  }
}

}  // namespace
}  // namespace palpate::haptics
