// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/reduced_chi2.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace palpate::haptics {
namespace {

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
