// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "field_objective.h"

#include <gtest/gtest.h>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

// Central differences with step 1e-5 of functions of order 1 to 10.
constexpr double kStep = 1e-5;
constexpr double kTolerance = 1e-7;

FieldObjective some_objective() {
  const Eigen::Matrix3Xd displacements = random_points(15, 3);
  return {displacements, random_points(15, 2, 2), 1.3, 0.1};
}

TEST(FieldObjective, ValueIsTheMeanSquaredResidual) {
  FieldObjective objective = some_objective();
  objective.weight_penalty = 0;
  const Eigen::Matrix3Xd residual =
      forces_at(to_field(to_parameters(some_field()), 1.3), objective.displacements) -
      objective.forces;
  EXPECT_NEAR(objective.value(to_parameters(some_field())), residual.squaredNorm() / 30, 1e-12);
}

TEST(FieldObjective, DerivativesAgreeWithDifferences) {
  const FieldObjective objective = some_objective();
  const Eigen::VectorXd at = to_parameters(some_field());
  const Eigen::VectorXd gradient = objective.gradient(at);
  const Eigen::MatrixXd hessian = objective.hessian(at);
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const Eigen::VectorXd h = kStep * Eigen::VectorXd::Unit(at.size(), i);
    EXPECT_NEAR(gradient[i], (objective.value(at + h) - objective.value(at - h)) / (2 * kStep),
                kTolerance);
    const Eigen::VectorXd column =
        (objective.gradient(at + h) - objective.gradient(at - h)) / (2 * kStep);
    EXPECT_LT((hessian.col(i) - column).norm(), kTolerance) << i;
  }
}

TEST(FieldObjective, ContractionOfTheStiffnessAgreesWithDifferences) {
  const FieldObjective objective = some_objective();
  const Eigen::VectorXd at = to_parameters(some_field());
  Eigen::Matrix3d factor;
  factor << 1.1, -0.3, 0.4, -0.3, 0.7, 0.2, 0.4, 0.2, -0.9;
  const FieldObjective::Contraction contraction = objective.stiffness_at_zero(at, factor);
  const Eigen::Matrix3d zero_stiffness = stiffness(to_field(at, 1.3), Eigen::Vector3d::Zero());
  EXPECT_NEAR(contraction.value, zero_stiffness.cwiseProduct(factor).sum(), 1e-12);
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const Eigen::VectorXd h = kStep * Eigen::VectorXd::Unit(at.size(), i);
    const auto above = objective.stiffness_at_zero(at + h, factor);
    const auto below = objective.stiffness_at_zero(at - h, factor);
    EXPECT_NEAR(contraction.gradient[i], (above.value - below.value) / (2 * kStep), kTolerance);
    EXPECT_LT((contraction.hessian.col(i) - (above.gradient - below.gradient) / (2 * kStep)).norm(),
              kTolerance);
  }
}

}  // namespace
}  // namespace palpate::haptics
