// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/rate_dependence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "not_finite.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

/// A trial that was dragged by 1 mm/N, and whose loop lost a share of 0.5 N mm.
TrialRecord measured_trial(double tangential, double lost, double creep) {
  TrialRecord record{
      .order = {.direction = 0, .tangential_force = {tangential, 0, 0}},
      .result = {.outcome = TrialOutcome::held, .b = Vector3d(tangential, 0, 0), .creep = creep}};
  record.result.work_dragging = 0.5;
  record.result.work_releasing = -0.5 * (1 - lost);
  return record;
}

TEST(RateDependence, IsTheMedianOfTheTrials) {
  const std::vector<TrialRecord> trials{measured_trial(1, 0.3, 0.4), measured_trial(0.8, 0.2, 0.1),
                                        measured_trial(0.5, 0.9, 0.2)};
  const RateDependence found = rate_dependence(trials);
  EXPECT_EQ(found.loops, 3);
  EXPECT_NEAR(found.energy_lost, 0.3, 1e-12);
  EXPECT_EQ(found.creeps, 3);
  EXPECT_EQ(found.creep, 0.2);
}

TEST(RateDependence, DoesNotTakeTrialsThatSlippedOrDoNotStandOutOfTheNoise) {
  std::vector<TrialRecord> trials(6, measured_trial(1, 0.5, 0.5));
  trials[1].result.outcome = TrialOutcome::slipped;
  trials[2].order.direction = -1;
  trials[3].order.tangential_force.x() = 0.39;  // [N] 39 times the noise
  trials[4].result.b.x() = 0.21;                // [mm] less than 10 times the noise
  trials[5].result.work_dragging = kNaN;
  const RateDependence found = rate_dependence(trials);
  EXPECT_EQ(found.loops, 1);
  EXPECT_EQ(found.creeps, 2);
  EXPECT_EQ(rate_dependence(trials, {.force_noise = 0.009}).loops, 2);
  EXPECT_EQ(rate_dependence(trials, {.position_noise = 0.02}).loops, 2);
}

TEST(RateDependence, IsUnknownWithoutTrials) {
  const RateDependence found = rate_dependence({});
  EXPECT_EQ(found.loops, 0);
  EXPECT_TRUE(std::isnan(found.energy_lost));
  EXPECT_TRUE(std::isnan(found.creep));
}

}  // namespace
}  // namespace palpate::probing
