// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/whitened_problem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

TEST(WhitenedProblem, JacobianIsThatOfTheResiduals) {
  ForceField field = some_field_with_ridge();
  for (Multiquadric& base : field.bases) base.weight = std::abs(base.weight);
  const Eigen::Matrix3Xd places = random_points(20, 3);
  WhitenedProblem problem(places, forces_at(field, places), {0.05, 0.1});
  problem.whiten(field);
  const Eigen::MatrixXd jacobian = problem.jacobian(field);
  constexpr double kStep = 1e-6;
  const auto changed = [&](std::size_t k, int parameter, double by) {
    ForceField other = field;
    Multiquadric& base = other.bases[k];
    if (parameter == 0) base.weight += by;
    if (parameter == 1) base.epsilon *= std::exp(by);
    if (parameter >= 2 && !is_ridge(base)) base.center[parameter - 2] += by;
    if (parameter == 2 && is_ridge(base)) base.center += by * base.ridge;
    if (parameter >= 3 && is_ridge(base)) {
      const double offset = base.ridge.dot(base.center);
      base.ridge = (base.ridge + by * tangents(base.ridge).col(parameter - 3)).normalized();
      base.center = offset * base.ridge;
    }
    return problem.residuals(other);
  };
  for (std::size_t k = 0; k < field.bases.size(); ++k) {
    for (int parameter = 0; parameter < 5; ++parameter) {
      const Eigen::VectorXd difference =
          (changed(k, parameter, kStep) - changed(k, parameter, -kStep)) / (2 * kStep);
      const Eigen::VectorXd column = jacobian.col(5 * static_cast<Eigen::Index>(k) + parameter);
      EXPECT_LT((difference - column).norm(), 1e-6 * (1 + column.norm())) << k << parameter;
    }
  }
}

constexpr int kSamples = 4000;

Eigen::VectorXd squares_of_noise() {
  std::mt19937 random(3);
  std::chi_squared_distribution<double> square(3);
  return Eigen::VectorXd::NullaryExpr(kSamples, [&] { return square(random); });
}

TEST(ReducedChi2, IsOneWhereNoiseMakesTheErrors) {
  const ReducedChi2 chi2 = reduced_chi2(squares_of_noise(), 0);
  EXPECT_NEAR(chi2.value, 1, 4 * std::sqrt(2.0 / (3 * kSamples)));
  EXPECT_EQ(chi2.outliers, 0);
}

TEST(ReducedChi2, CountsTheParametersThatWereFitted) {
  const Eigen::VectorXd squares = Eigen::VectorXd::Constant(20, 2);
  EXPECT_DOUBLE_EQ(reduced_chi2(squares, 10).value, 40.0 / 50);
  EXPECT_DOUBLE_EQ(reduced_chi2(squares, 70).value, 40);  // no degree of freedom is left
}

TEST(ReducedChi2, LeavesOutAFewOutliersButNotMany) {
  Eigen::VectorXd squares = Eigen::VectorXd::Constant(100, 3);
  squares.head<5>().setConstant(1e4);
  const ReducedChi2 few = reduced_chi2(squares, 0);
  EXPECT_DOUBLE_EQ(few.value, 1);
  EXPECT_EQ(few.outliers, 5);
  squares.head<20>().setConstant(1e4);
  EXPECT_GT(reduced_chi2(squares, 0).value, 100);
}

}  // namespace
}  // namespace palpate::haptics
