// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/field_objective.h"

#include <gtest/gtest.h>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

FieldObjective some_objective() {
  const Eigen::Matrix3Xd displacements = random_points(15, 3);
  return {displacements, random_points(15, 2, 2), 0.1};
}

TEST(FieldObjective, ValueIsTheMeanSquaredResidual) {
  FieldObjective objective = some_objective();
  objective.weight_penalty = 0;
  const Eigen::Matrix3Xd residual =
      forces_at(some_field(), objective.displacements) - objective.forces;
  EXPECT_NEAR(objective.value(to_parameters(some_field())), residual.squaredNorm() / 30, 1e-12);
}

TEST(FieldObjective, DerivativesAgreeWithDifferences) {
  const FieldObjective objective = some_objective();
  const Eigen::VectorXd at = to_parameters(some_field());
  const Eigen::VectorXd gradient = objective.gradient(at);
  const Eigen::MatrixXd hessian = objective.hessian(at);
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const Eigen::VectorXd h = kDifferenceStep * Eigen::VectorXd::Unit(at.size(), i);
    EXPECT_NEAR(gradient[i],
                (objective.value(at + h) - objective.value(at - h)) / (2 * kDifferenceStep),
                kDifferenceTolerance);
    const Eigen::VectorXd column =
        (objective.gradient(at + h) - objective.gradient(at - h)) / (2 * kDifferenceStep);
    EXPECT_LT((hessian.col(i) - column).norm(), kDifferenceTolerance) << i;
  }
}

// Value, gradient and Hessian of a function of the parameters agree with differences.
template <typename Function>
void expect_derivatives(Function&& function) {
  const Eigen::VectorXd at = to_parameters(some_field());
  const FieldFunction here = function(at);
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const Eigen::VectorXd h = kDifferenceStep * Eigen::VectorXd::Unit(at.size(), i);
    const FieldFunction above = function(at + h), below = function(at - h);
    EXPECT_NEAR(here.gradient[i], (above.value - below.value) / (2 * kDifferenceStep),
                kDifferenceTolerance)
        << i;
    const Eigen::VectorXd column = (above.gradient - below.gradient) / (2 * kDifferenceStep);
    EXPECT_LT((here.hessian.col(i) - column).norm(), kDifferenceTolerance) << i;
  }
}

TEST(FieldObjective, ContractionOfTheStiffnessAgreesWithDifferences) {
  Eigen::Matrix3d factor;
  factor << 1.1, -0.3, 0.4, -0.3, 0.7, 0.2, 0.4, 0.2, -0.9;
  const Eigen::VectorXd at = to_parameters(some_field());
  const Eigen::Matrix3d zero_stiffness = stiffness(some_field(), Eigen::Vector3d::Zero());
  EXPECT_NEAR(stiffness_at_zero(at, factor).value, zero_stiffness.cwiseProduct(factor).sum(),
              1e-12);
  expect_derivatives(
      [&](const Eigen::VectorXd& parameters) { return stiffness_at_zero(parameters, factor); });
}

TEST(FieldObjective, EnergyAgreesWithTheFieldAndWithDifferences) {
  const Eigen::Vector3d place(1.1, -2.7, 0.4);
  EXPECT_NEAR(energy_at(to_parameters(some_field()), place).value, potential(some_field(), place),
              1e-12);
  expect_derivatives(
      [&](const Eigen::VectorXd& parameters) { return energy_at(parameters, place); });
}

TEST(FieldObjective, ParametersHoldTheWholeField) {
  EXPECT_EQ(to_field(to_parameters(some_field())), some_field());
}

}  // namespace
}  // namespace palpate::haptics
