// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "field_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

double smallest_stiffness(const FieldSolution& solution) {
  const Eigen::Matrix3d zero_stiffness =
      stiffness(to_field(solution.parameters, 1), Eigen::Vector3d::Zero());
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(zero_stiffness).eigenvalues()[0];
}

FieldObjective spring(double x_stiffness) {
  FieldObjective objective;
  objective.displacements = random_points(80, 1.5);
  objective.forces = 0.6 * objective.displacements;
  objective.forces.row(0) = x_stiffness * objective.displacements.row(0);
  objective.weight_penalty = 1e-6;
  return objective;
}

TEST(SolveField, StopsAtAMinimumWhereTheConstraintDoesNotMatter) {
  const FieldObjective objective = spring(0.6);
  const FieldSolution solution = solve_field(objective, Eigen::Vector4d(1, 0.1, -0.2, 0.3));
  EXPECT_TRUE(solution.converged);
  EXPECT_LT(objective.gradient(solution.parameters).norm(), 1e-4);
  EXPECT_GT(smallest_stiffness(solution), 0.1);
  EXPECT_NEAR(solution.value, objective.value(solution.parameters), 1e-12);
}

TEST(SolveField, EndsOnTheConstraintWhereTheDataLieBeyondIt) {
  // Without the constraint these two bases would take over the negative spring along x.
  Eigen::VectorXd start(8);
  start << 1, 0, 1.5, 0.2, 1, 0.1, -1.5, 0;
  const FieldObjective objective = spring(-0.6);
  const FieldSolution solution = solve_field(objective, start);
  EXPECT_TRUE(solution.converged);
  EXPECT_GE(smallest_stiffness(solution), 0);
  EXPECT_LT(smallest_stiffness(solution), 1e-3);
  EXPECT_LT(objective.value(solution.parameters), objective.value(start));
}

}  // namespace
}  // namespace palpate::haptics
