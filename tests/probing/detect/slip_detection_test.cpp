// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/slip_detection.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "not_finite.h"
#include "simulated_slip.h"

namespace palpate::probing {
namespace {

using support::simulate_trial;
using support::SimulatedTrial;

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

/// Wrong decisions of trials below and above the friction limit at contacts with one share of
/// compliance in the contact itself, where each trial is judged with what those before it showed.
struct WrongDecisions {
  int below = 0, above = 0;
};
WrongDecisions decisions_with_learnt_microslip(double share, bool learnt) {
  WrongDecisions wrong;
  std::mt19937_64 random(1);
  for (int contact = 0; contact < 100; ++contact) {
    support::SimulatedSpring spring = support::any_spring(random);
    spring.share = share;
    std::vector<HeldDrag> drags;
    for (int i = 0; i < 40; ++i) {
      const SimulatedTrial simulated = simulate_trial(spring, random);
      const double ratio =
          simulated.trial.tangential_force.norm() / simulated.trial.normal_force.norm();
      SlipOptions options;
      if (learnt) options.microslip = allowed_microslip(drags, ratio, options.microslip);
      const bool slipped = judge_slip(simulated.trial, options)->slipped;
      if (!slipped) drags.push_back(*held_drag(simulated.trial));
      if (slipped != simulated.slipped) ++(simulated.slipped ? wrong.above : wrong.below);
    }
  }
  return wrong;
}

TEST(SlipDetection, LearnsFromDragsThatHeldThatASheetHasNoMicroslip) {
  const WrongDecisions fixed = decisions_with_learnt_microslip(0, false);
  const WrongDecisions learnt = decisions_with_learnt_microslip(0, true);
  EXPECT_LE(learnt.above, 0.75 * fixed.above);
  EXPECT_LE(learnt.below, 10);  // of about 1900: noise alone, 1 in 1000
}

TEST(SlipDetection, StillAllowsForTheMicroslipThatDragsShow) {
  for (const double share : {0.3, 0.6, 1.0}) {
    EXPECT_LE(decisions_with_learnt_microslip(share, true).below,
              decisions_with_learnt_microslip(share, false).below + 4)
        << share;  // of about 1900
  }
}

TEST(SlipDetection, AllowsMostMicroslipBeforeAnyDragHeld) {
  EXPECT_EQ(allowed_microslip({}, 0.5, 0.2), 0.2);
  // A drag far from the limit tells nothing.
  const HeldDrag weak{.ratio = 0.01, .share = 0, .share_deviation = 0.05};
  EXPECT_EQ(allowed_microslip({&weak, 1}, 1, 0.2), 0.2);
}

/// Wrong decisions at one contact, of an arm whose noise is told `overstated` times as large as it
/// is. Each trial is judged with what those before it showed.
WrongDecisions decisions_with_learnt_noise(double overstated, bool learnt) {
  WrongDecisions wrong;
  std::mt19937_64 random(1);
  const support::SimulatedSpring spring{.compliance = 4, .share = 0};
  std::vector<double> held;
  SlipOptions options{.position_deviation = 0.02 * overstated,
                      .force_deviation = 0.005 * overstated,
                      .microslip = 0};
  for (int i = 0; i < 5000; ++i) {
    const SimulatedTrial simulated = simulate_trial(spring, random);
    if (learnt) options.threshold = allowed_threshold(held);
    const SlipJudgement judgement = *judge_slip(simulated.trial, options);
    if (!judgement.slipped) held.push_back(judgement.t_squared);
    if (judgement.slipped != simulated.slipped) ++(simulated.slipped ? wrong.above : wrong.below);
  }
  return wrong;
}

TEST(SlipDetection, FindsMoreSlidesOnceTrialsShowThatNoiseWasOverstated) {
  const WrongDecisions fixed = decisions_with_learnt_noise(3, false);
  const WrongDecisions learnt = decisions_with_learnt_noise(3, true);
  EXPECT_LE(learnt.above, 0.6 * fixed.above);
  EXPECT_LE(learnt.below, 3);  // of about 2400
}

TEST(SlipDetection, KeepsItsThresholdWhereTheToldNoiseIsTrue) {
  const WrongDecisions fixed = decisions_with_learnt_noise(1, false);
  const WrongDecisions learnt = decisions_with_learnt_noise(1, true);
  EXPECT_EQ(learnt.above, fixed.above);
  EXPECT_EQ(learnt.below, fixed.below);
  EXPECT_EQ(allowed_threshold(std::vector<double>(11, 0.1)), SlipOptions{}.threshold);
  EXPECT_EQ(allowed_threshold(std::vector<double>(12, 0)), SlipOptions{}.threshold / 16);
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
