// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/whitened_problem.h"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace palpate::haptics
