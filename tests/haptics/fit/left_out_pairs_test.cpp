// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/left_out_pairs.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "haptics_testing.h"
#include "palpate/haptics/force_field_fit.h"

namespace palpate::haptics {
namespace {

constexpr SampleNoise kLeftOutNoise{.displacement = 0, .force = 0.01};

// Pairs of a convex field, with noise of the force.
WhitenedProblem noisy_problem(Eigen::Index count) {
  const ForceField field = spring(3, 0.8);
  const Eigen::Matrix3Xd places = random_points(count, 1.5);
  Eigen::Matrix3Xd forces = forces_at(field, places);
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, kLeftOutNoise.force);
  for (double& number : forces.reshaped()) number += normal(random);
  return {places, forces, kLeftOutNoise};
}

LeftOutOptions left_out_options() { return {.noise = kLeftOutNoise, .max_bases = kMaxConvexBases}; }

// A fit that knew the pairs would be nearer to them than their noise.
TEST(LeftOutPairs, AreMissedByTheirNoiseAndThatOfTheFit) {
  const Eigen::VectorXd squares = left_out_squares(noisy_problem(60), left_out_options());
  ASSERT_EQ(squares.size(), 60);
  EXPECT_GT(squares.mean(), 3 * 0.8);
  EXPECT_LT(squares.mean(), 3 * 2.5);
}

TEST(LeftOutPairs, DoNotMoveTheFitThatPredictsThem) {
  const WhitenedProblem clean = noisy_problem(60);
  Eigen::Matrix3Xd forces = clean.forces();
  const Eigen::Vector3d push(0.03, -0.02, 0.03);  // no outlier: a fit would follow it
  forces.col(17) += push;
  const WhitenedProblem pushed(clean.displacements(), forces, kLeftOutNoise);
  const Eigen::VectorXd before = left_out_squares(clean, left_out_options());
  const Eigen::VectorXd after = left_out_squares(pushed, left_out_options());
  // Those of its own part are predicted by the same fit as before.
  for (Eigen::Index i = 17 % kLeftOutParts; i < 60; i += kLeftOutParts) {
    if (i == 17) continue;
    EXPECT_EQ(after[i], before[i]) << i;
  }
  EXPECT_NE(after[17], before[17]);
}

TEST(LeftOutPairs, HaveStatisticsThatOutliersHardlyMove) {
  Eigen::VectorXd squares(5);
  squares << 4, 1, 3 * kMedianChi2, 1e6, 9;
  EXPECT_DOUBLE_EQ(typical_variance(squares), 3);
  EXPECT_DOUBLE_EQ(capped_mean(squares, 10), (4 + 1 + 3 * kMedianChi2 + 10 + 9) / 5);
}

TEST(LeftOutPairs, ErrAsMuchMoreAsParametersWereFitted) {
  EXPECT_DOUBLE_EQ(expected_growth(0, 75), 1);
  EXPECT_DOUBLE_EQ(expected_growth(25, 75), 9.0 / 4);
  EXPECT_EQ(expected_growth(75, 75), std::numeric_limits<double>::infinity());
  EXPECT_EQ(expected_growth(80, 75), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace palpate::haptics
