// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/compliance_kriging.h"

#include <gtest/gtest.h>

#include <cmath>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

Compliance quadratic(const Eigen::Vector2d& p) {
  Compliance value;
  value << 0.1 * p.x(), 0.02 * p.y(), 20 - 0.1 * p.x() - 0.005 * p.x() * p.x(), 1 + 0.01 * p.y(), 0,
      4 - 0.001 * p.x() * p.x();
  return value;
}

// A grid without its middle, which is the place.
Surroundings grid(const Eigen::Vector2d& middle) {
  Surroundings around;
  around.places.resize(2, 24);
  around.values.resize(6, 24);
  Eigen::Index count = 0;
  for (int i = -2; i <= 2; ++i) {
    for (int j = -2; j <= 2; ++j) {
      if (i == 0 && j == 0) continue;
      const Eigen::Vector2d step(10.0 * i, 10.0 * j);
      around.contacts.push_back(static_cast<int>(count));
      around.places.col(count) = step;
      around.values.col(count++) = quadratic(middle + step);
    }
  }
  return around;
}

Covariance some_covariance() {
  Covariance covariance;
  covariance.whiten = Eigen::Vector2d(1.0 / 60, 1.0 / 90).asDiagonal();
  covariance.nugget = 1e-6;
  covariance.amplitude.setOnes();
  return covariance;
}

TEST(PredictCompliance, FollowsASmoothFunctionAndKeepsAConstant) {
  const Eigen::Vector2d middle(7, -3);
  Surroundings around = grid(middle);
  const KrigingPrediction found = predict_compliance(around, some_covariance());
  EXPECT_LT((found.value - quadratic(middle)).norm(), 0.01);
  EXPECT_GT(found.variance, 0);
  EXPECT_LT(found.variance, 0.01);
  around.values.colwise() = quadratic(middle);
  EXPECT_LT((predict_compliance(around, some_covariance()).value - quadratic(middle)).norm(), 1e-9);
}

TEST(PredictCompliance, IsLessSureFarFromContacts) {
  Surroundings around = grid({0, 0});
  const double inside = predict_compliance(around, some_covariance()).variance;
  around.places.colwise() += Eigen::Vector2d(40, 0);
  EXPECT_GT(predict_compliance(around, some_covariance()).variance, 10 * inside);
}

TEST(KrigingTrend, IsTheDerivativeOfASmoothFunction) {
  const Eigen::Vector2d middle(7, -3);
  const auto trend = kriging_trend(grid(middle), quadratic(middle), some_covariance());
  EXPECT_NEAR(trend(0, 0), 0.1, 2e-3);
  EXPECT_NEAR(trend(1, 1), 0.02, 2e-3);
  EXPECT_NEAR(trend(2, 0), -0.1 - 0.01 * 7, 5e-3);
  EXPECT_NEAR(trend(2, 2), -0.01, 1e-3);
  EXPECT_NEAR(trend(2, 3), 0, 1e-3);
  EXPECT_NEAR(trend(2, 4), 0, 1e-3);
  EXPECT_EQ(kriging_trend({}, quadratic(middle), some_covariance()).norm(), 0);
}

TEST(LearnCovariance, FindsAlongWhichDirectionCompliancesChange) {
  std::vector<Surroundings> around;
  std::vector<Compliance> values;
  const auto wave = [](const Eigen::Vector2d& p) {
    Compliance value;
    const double along = 0.6 * p.x() + 0.8 * p.y();
    value << 0, 0, 20 + 5 * std::sin(0.08 * along), 1, 0, 4 + std::cos(0.08 * along);
    return value;
  };
  const Eigen::Matrix3Xd places = random_points(12, 50);
  for (const auto& at : places.colwise()) {
    const Eigen::Vector2d middle = at.head<2>();
    around.push_back(grid(middle));
    for (Eigen::Index j = 0; j < 24; ++j) {
      around.back().values.col(j) = wave(middle + around.back().places.col(j));
    }
    values.push_back(wave(middle));
  }
  const Covariance found = learn_covariance(around, values, 10);
  const double along = (found.whiten * Eigen::Vector2d(0.6, 0.8)).norm();
  const double across = (found.whiten * Eigen::Vector2d(-0.8, 0.6)).norm();
  EXPECT_GT(along, 2 * across);
  EXPECT_GT(found.amplitude(2), 100 * found.amplitude(0));
  EXPECT_GT(found.nugget, 0);
}

}  // namespace
}  // namespace palpate::haptics
