// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/slip_detection.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "not_finite.h"
#include "simulated_slip.h"

namespace palpate::probing {
namespace {

using testing::simulate_trial;
using testing::SimulatedTrial;

/// Share of trials with a load in a range that are judged wrongly.
double wrong_share(double low, double high, int runs, const SlipOptions& options = {}) {
  int wrong = 0, count = 0;
  for (unsigned seed = 1; count < runs; ++seed) {
    const SimulatedTrial simulated = simulate_trial(seed);
    if (simulated.load < low || simulated.load > high) continue;
    ++count;
    const auto judgement = judge_slip(simulated.trial, options);
    if (!judgement || judgement->slipped != simulated.slipped) ++wrong;
  }
  return static_cast<double>(wrong) / count;
}

TEST(SlipDetection, IsRightAwayFromTheLimitAndNearlySoAtIt) {
  EXPECT_LE(wrong_share(0, 0.9, 5000), 0.005);
  EXPECT_LE(wrong_share(1.1, 2, 5000), 0.005);
  EXPECT_LE(wrong_share(0, 2, 10000), 0.02);
}

TEST(SlipDetection, MistakesMicroslipForSlipIfItIsNotAllowedFor) {
  SlipOptions options;
  options.microslip = 0;
  EXPECT_GT(wrong_share(0.5, 0.9, 2000, options), 0.1);
}

TEST(SlipDetection, ThresholdGrowsWithTheMeasuredCompliance) {
  SlipTrial trial;
  trial.normal_force = {0, 0, 1};
  trial.tangential_force = {0.4, 0, 0};
  trial.a_again = {0, 0.2, 0};  // across, where nothing but noise may be left
  EXPECT_TRUE(judge_slip(trial)->slipped);
  trial.a = {0, 0, 10};
  trial.b = {4, 0, 10};
  trial.a_again = {0, 0.2, 10};
  EXPECT_FALSE(judge_slip(trial)->slipped);
  EXPECT_NEAR(judge_slip(trial)->t_squared, 0.04 / (2 * (0.0004 + 0.000025 * 100)), 1e-12);
  EXPECT_NEAR(judge_slip(trial)->distance, 0.2, 1e-12);
}

TEST(SlipDetection, FallenOffHasSlipped) {
  SlipTrial trial;
  trial.normal_force = {0, 0, 1};
  trial.tangential_force = {1, 0, 0};
  trial.b = Eigen::Vector3d::Constant(kNaN);
  EXPECT_FALSE(judge_slip(trial));
  trial.fell_off = true;
  ASSERT_TRUE(judge_slip(trial));
  EXPECT_TRUE(judge_slip(trial)->slipped);
}

TEST(SlipDetection, JudgesNothingFromAnIncompleteTrial) {
  const SlipTrial complete = simulate_trial(1).trial;
  ASSERT_TRUE(judge_slip(complete));
  for (Eigen::Vector3d SlipTrial::*field :
       {&SlipTrial::contact, &SlipTrial::normal_force, &SlipTrial::tangential_force, &SlipTrial::a,
        &SlipTrial::b, &SlipTrial::a_again, &SlipTrial::creep}) {
    SlipTrial trial = complete;
    (trial.*field).y() = kNaN;
    EXPECT_FALSE(judge_slip(trial));
  }
  SlipTrial trial = complete;
  trial.tangential_force.setZero();
  EXPECT_FALSE(judge_slip(trial));
}

TEST(SlipDetection, MovesWithTheFrame) {
  const SlipTrial trial = simulate_trial(7).trial;
  const Eigen::AngleAxisd turn(1.1, Eigen::Vector3d(1, 2, -0.5).normalized());
  const Eigen::Vector3d shift(100, -20, 3);
  SlipTrial moved = trial;
  for (Eigen::Vector3d SlipTrial::*place :
       {&SlipTrial::contact, &SlipTrial::a, &SlipTrial::b, &SlipTrial::a_again}) {
    moved.*place = turn * (trial.*place) + shift;
  }
  for (Eigen::Vector3d SlipTrial::*vector :
       {&SlipTrial::normal_force, &SlipTrial::tangential_force, &SlipTrial::creep}) {
    moved.*vector = turn * (trial.*vector);
  }
  EXPECT_NEAR(judge_slip(moved)->t_squared, judge_slip(trial)->t_squared, 1e-8);
}

}  // namespace
}  // namespace palpate::probing
