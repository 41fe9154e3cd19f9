// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/series_compliance.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

constexpr PairNoise kPairNoise{0.02, 0.01};

// A local part that stiffens: 2 mm/N at rest along each axis.
const ForceField kLocal = spring(4, 2);

Eigen::Matrix3d some_compliance() {
  Eigen::Matrix3d compliance;
  compliance << 0.6, 0.1, -0.2, 0.1, 0.9, 0.3, -0.2, 0.3, 1.4;
  return compliance;
}

ForceSamples samples_of(const Series& series, const Eigen::Matrix3Xd& forces) {
  ForceSamples samples;
  samples.forces = samples.displacements = forces;
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    samples.displacements.col(i) = series.displacement(forces.col(i));
  }
  return samples;
}

TEST(SeriesCompliance, IsFoundFromTwoForces) {
  const ForceSamples samples = samples_of({kLocal, some_compliance()}, random_points(2, 3));
  const Eigen::Matrix3d found = fit_global_compliance(
      samples, kLocal, {Eigen::Matrix3d::Zero(), 100}, kPairNoise, samples.forces);
  // Two forces leave one of six numbers open; what they tell is met.
  EXPECT_LT(
      (samples_of({kLocal, found}, samples.forces).displacements - samples.displacements).norm(),
      1e-3);
  EXPECT_EQ(found, found.transpose());
}

TEST(SeriesCompliance, TakesFromThePriorWhatSamplesLeaveOpen) {
  const Eigen::Matrix3d mean = 0.7 * Eigen::Matrix3d::Identity();
  const ForceSamples samples =
      samples_of({kLocal, some_compliance()}, 2 * Eigen::Vector3d::UnitZ());
  const Eigen::Matrix3d found =
      fit_global_compliance(samples, kLocal, {mean, 3}, kPairNoise, samples.forces);
  EXPECT_LT((found.col(2) - some_compliance().col(2)).norm(), 2e-3);
  EXPECT_NEAR(found(0, 0), 0.7, 1e-6);
  EXPECT_NEAR(found(1, 1), 0.7, 1e-6);
  EXPECT_NEAR(found(0, 1), 0, 1e-6);
}

TEST(SeriesCompliance, FollowsTheMostOfTheSamples) {
  ForceSamples samples = samples_of({kLocal, some_compliance()}, random_points(12, 3));
  samples.displacements.col(5) += Eigen::Vector3d(3, -4, 2);
  const Eigen::Matrix3d found = fit_global_compliance(samples, kLocal, {Eigen::Matrix3d::Zero(), 5},
                                                      kPairNoise, samples.forces);
  EXPECT_LT((found - some_compliance()).norm(), 0.02);
}

TEST(SeriesCompliance, NeverMakesTheWholeTurnBack) {
  // Less than the local part alone yields.
  const Eigen::Matrix3d wanted = -1.9 * Eigen::Matrix3d::Identity();
  const ForceSamples samples = samples_of({kLocal, wanted}, random_points(20, 3));
  const Eigen::Matrix3d found = fit_global_compliance(samples, kLocal, {Eigen::Matrix3d::Zero(), 5},
                                                      kPairNoise, samples.forces);
  double least = 1;
  for (const auto& f : samples.forces.colwise()) {
    const Eigen::Matrix3d whole = Series{kLocal, found}.compliance(f);
    least = std::min(least, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(whole).eigenvalues()[0]);
  }
  EXPECT_GT(least, -1e-9);
  EXPECT_LT(least, 1e-6);
}

TEST(SeriesCompliance, Chi2IsOneWhereNoiseMakesTheErrors) {
  ForceSamples samples = samples_of({kLocal, some_compliance()}, random_points(400, 3));
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (double& d : samples.displacements.reshaped()) d += 0.02 * normal(random);
  const Series series{kLocal, some_compliance()};
  EXPECT_NEAR(chi2(series, samples, {0.02, 1e-6}), 1, 0.15);
  EXPECT_GT(chi2(series, samples, {0.01, 1e-6}), 3);
  samples.displacements.leftCols(20).array() += 5;  // outliers, few
  EXPECT_NEAR(chi2(series, samples, {0.02, 1e-6}), 1, 0.15);
}

TEST(SeriesCompliance, SpreadsColumnsFromTheLongestOn) {
  Eigen::Matrix3Xd points = 0.1 * random_points(50, 1);
  points.col(7) << 3, 0, 0;
  points.col(30) << -1, 0, 0;
  const Eigen::Matrix3Xd chosen = spread_columns(points, 3);
  EXPECT_EQ(chosen.col(0), points.col(7));
  EXPECT_EQ(chosen.col(1), points.col(30));
  EXPECT_EQ(spread_columns(points, 60), points);
}

}  // namespace
}  // namespace palpate::haptics
