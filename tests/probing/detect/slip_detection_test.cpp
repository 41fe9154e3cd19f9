// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/slip_detection.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "not_finite.h"

namespace palpate::probing {
namespace {

/// A trial with its truth. The object is an isotropic spring, a share of whose compliance is that
/// of a round contact, and whose surface is curved, so that a tip that slips comes to rest.
struct SimulatedTrial {
  SlipTrial trial;
  double load = 0;       // tangential force relative to the limit
  bool slipped = false;  // the tip slid
};

/// [relative to the displacement at full slip] of a round contact that was dragged with `load`
/// times the limit and released (Mindlin and Deresiewicz 1953).
double microslip_left(double load) {
  return 2 * std::pow(1 - load / 2, 2.0 / 3) - std::pow(1 - load, 2.0 / 3) - 1;
}

SimulatedTrial simulate_trial(unsigned seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto log_uniform = [&](double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  };
  std::normal_distribution<double> normal(0, 1);
  const auto noise = [&](double deviation) {
    return Eigen::Vector3d(deviation * normal(random), deviation * normal(random),
                           deviation * normal(random));
  };
  const double compliance = 1 / log_uniform(0.1, 5);  // [mm/N]
  const double share = uniform(0, 1);                 // of it in the contact itself
  const double friction = uniform(0.3, 1.5), radius = log_uniform(10, 100);  // [mm]
  const double pressing = log_uniform(0.1, 3), limit = friction * pressing;  // [N]
  SimulatedTrial result;
  result.load = uniform(0.1, 2);
  result.slipped = result.load > 1;
  const double force = result.load * limit;
  const double held = std::min(result.load, 1.0);
  const double contact_at_limit = 1.5 * limit * compliance * share;  // [mm] displacement
  const double stays = contact_at_limit * microslip_left(held);
  const double elastic =
      (1 - share) * compliance * force + contact_at_limit * (1 - std::pow(1 - held, 2.0 / 3));
  // The surface turns by distance / radius, which raises the limit by about that times the force.
  const double slid = result.slipped ? (result.load - 1) * friction * radius : 0.0;

  const Eigen::AngleAxisd turn(uniform(0, 3), Eigen::Vector3d(0.3, -0.5, 0.8).normalized());
  const Eigen::Vector3d n = turn * Eigen::Vector3d::UnitZ(), t = turn * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d creep = uniform(0, 0.1) * n;
  SlipTrial& trial = result.trial;
  trial.contact = {12, -7, 702};
  trial.normal_force = pressing * n;
  trial.tangential_force = force * t;
  constexpr double kPosition = 0.02, kForce = 0.004;  // [mm], [N] Table 4.1, compensated
  const auto measured = [&](const Eigen::Vector3d& place) -> Eigen::Vector3d {
    return place + noise(kPosition) + compliance * noise(kForce);
  };
  const Eigen::Vector3d pressed = trial.contact + compliance * pressing * n;
  trial.a = measured(pressed);
  trial.b = measured(pressed + (elastic + slid) * t + creep / 2);
  trial.a_again = measured(pressed + (stays + slid) * t + creep);
  trial.creep = 0.9 * creep;
  return result;
}

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
