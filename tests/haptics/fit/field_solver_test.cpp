// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/field_solver.h"

#include <gtest/gtest.h>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

Eigen::VectorXd start_of_one() { return to_parameters({{{1, 1, {0.1, -0.2, 0.3}}}}); }

// Two bases that would take over a negative spring along x.
Eigen::VectorXd start_of_two() {
  return to_parameters({{{1, 1, {0, 1.5, 0.2}}, {1, 1, {0.1, -1.5, 0}}}});
}

FieldObjective spring_objective(double x_stiffness) {
  FieldObjective objective;
  objective.displacements = random_points(80, 1.5);
  objective.forces = 0.6 * objective.displacements;
  objective.forces.row(0) = x_stiffness * objective.displacements.row(0);
  objective.weight_penalty = 1e-6;
  return objective;
}

TEST(SolveField, StopsAtAMinimumWhereTheConstraintDoesNotMatter) {
  const FieldObjective objective = spring_objective(0.6);
  const FieldSolution solution = solve_field(objective, start_of_one());
  EXPECT_TRUE(solution.converged);
  // Except for epsilon, which is kept.
  EXPECT_LT(objective.gradient(solution.parameters).head<4>().norm(), 1e-4);
  EXPECT_GT(stiffness_at_zero(to_field(solution.parameters)), 0.1);
  EXPECT_NEAR(solution.value, objective.value(solution.parameters), 1e-12);
}

TEST(SolveField, EndsOnTheConstraintWhereTheDataLieBeyondIt) {
  const FieldObjective objective = spring_objective(-0.6);
  const FieldSolution solution = solve_field(objective, start_of_two());
  EXPECT_TRUE(solution.converged);
  EXPECT_GE(stiffness_at_zero(to_field(solution.parameters)), 0);
  EXPECT_LT(stiffness_at_zero(to_field(solution.parameters)), 1e-3);
  EXPECT_LT(solution.value, objective.value(start_of_two()));
}

TEST(SolveField, KeepsTheStiffnessThatIsAskedFor) {
  FieldConstraints constraints;
  constraints.least_stiffness = 0.3;
  const FieldSolution solution = solve_field(spring_objective(-0.6), start_of_two(), constraints);
  EXPECT_TRUE(solution.converged);
  EXPECT_NEAR(stiffness_at_zero(to_field(solution.parameters)), 0.3, 1e-3);
}

TEST(SolveField, KeepsTheEnergyAtPlaces) {
  FieldConstraints constraints;
  const FieldObjective objective = spring_objective(-0.6);
  const Eigen::Vector3d place(1.4, 0, 0);
  const ForceField without = to_field(solve_field(objective, start_of_two()).parameters);
  ASSERT_LT(potential(without, place), 0.2 / 2 * place.squaredNorm());
  constraints.places = {place};
  constraints.least_secant = 0.2;
  const FieldSolution solution = solve_field(objective, start_of_two(), constraints);
  EXPECT_TRUE(solution.converged);
  EXPECT_NEAR(potential(to_field(solution.parameters), place), 0.2 / 2 * place.squaredNorm(), 1e-3);
}

TEST(SolveField, MovesTheEpsilonOnlyIfItIsFree) {
  const ForceField truth{{{1.3, 1.4, {0.2, 0.3, -0.4}}}};
  FieldObjective objective = spring_objective(1);
  objective.forces = forces_at(truth, objective.displacements);
  objective.weight_penalty = 0;
  FieldConstraints constraints;
  EXPECT_EQ(
      to_field(solve_field(objective, start_of_one(), constraints).parameters).bases[0].epsilon, 1);
  constraints.free_epsilon = true;
  const FieldSolution solution = solve_field(objective, start_of_one(), constraints);
  EXPECT_TRUE(solution.converged);
  EXPECT_NEAR(to_field(solution.parameters).bases[0].epsilon, 1.4, 0.01);
  EXPECT_NEAR(to_field(solution.parameters).bases[0].weight, 1.3, 0.01);
}

}  // namespace
}  // namespace palpate::haptics
