// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "friction/load_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

const Eigen::Vector3d kLoadedNormal(0, 0, -1);

// A contact whose limit of the tangential force is mu f_N (f_N / 1 N)^p, and what errs there.
struct LoadedProbing {
  double friction = 0.7;
  double exponent = 0;
  Eigen::Vector3d axis = Eigen::Vector3d(0.05, -0.03, 1).normalized();
  double noise = 0.01;  ///< [N]
  double steady = 0;    ///< [N] by which the tangential force is less than commanded
  int directions = 8;
};

// Bisections as an arm makes them, judged by the physical condition alone.
std::vector<FrictionTrial> probe_loaded(const LoadedProbing& with, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, with.noise);
  std::uniform_real_distribution<double> uniform;
  std::vector<FrictionTrial> trials;
  const double first = 2 * std::numbers::pi * uniform(random);
  for (const double level : {0.3, 0.7, 1.5, 2.6}) {
    for (int i = 0; i < with.directions; ++i) {
      const double angle = first + 2 * std::numbers::pi * i / with.directions;
      const Eigen::Vector3d across(std::cos(angle), std::sin(angle), 0);
      const auto slips = [&](double size) {
        const Eigen::Vector3d commanded = size * across - level * kLoadedNormal;
        const Eigen::Vector3d f = commanded - std::min(with.steady, size) * across +
                                  Eigen::Vector3d{noise(random), noise(random), noise(random)};
        const double along = f.dot(with.axis);
        const double limit = with.friction * along * std::pow(along, with.exponent);
        trials.push_back({commanded, (f - along * with.axis).norm() > limit});
        return trials.back().slipped;
      };
      double low = 0, high = 3.5;
      while (high - low > 0.03) (slips((low + high) / 2) ? high : low) = (low + high) / 2;
    }
  }
  return trials;
}

std::vector<LoadedContact> probe_object(const LoadedProbing& with, const FrictionOptions& options,
                                        unsigned seed, int contacts = 6) {
  std::vector<LoadedContact> result;
  for (int i = 0; i < contacts; ++i) {
    LoadedProbing here = with;
    here.friction *= 1 + 0.05 * (i - contacts / 2);
    const std::vector<FrictionTrial> trials =
        probe_loaded(here, 100 * seed + static_cast<unsigned>(i));
    result.push_back({trials, fit_friction(trials, kLoadedNormal, options)});
  }
  return result;
}

TEST(FrictionLoadEstimate, FindsTheExponentOfTheTrials) {
  double squares = 0;
  constexpr int kCount = 6;
  for (unsigned seed = 0; seed < kCount; ++seed) {
    const double exponent = seed % 2 == 0 ? -0.12 : 0.08;
    const auto found = estimate_friction_load(probe_object({.exponent = exponent}, {}, seed), {});
    ASSERT_TRUE(found) << seed;
    EXPECT_NEAR(found->load.exponent, exponent, 0.015) << seed;
    EXPECT_LT(found->exponent_error, 0.01);
    squares += std::pow((found->load.exponent - exponent) / found->exponent_error, 2) / kCount;
    // The median of the levels tried.
    EXPECT_GE(found->load.force, 0.7);
    EXPECT_LE(found->load.force, 1.5);
  }
  EXPECT_LT(squares, 2.7);  // mean of 6 squares of standard normal numbers: 1 +- 0.6
}

TEST(FrictionLoadEstimate, FindsNoneWhereTheConeIsStraight) {
  int found = 0;
  for (unsigned seed = 0; seed < 8; ++seed)
    found += estimate_friction_load(probe_object({}, {}, seed), {}).has_value();
  EXPECT_LE(found, 1);
}

TEST(FrictionLoadEstimate, TakesNoSteadyErrorOfTheForceForIt) {
  const FrictionOptions options{.steady_error = 0.02};
  int alone = 0, with = 0;
  for (unsigned seed = 0; seed < 4; ++seed) {
    const std::vector<LoadedContact> contacts = probe_object({.steady = 0.025}, options, seed);
    alone += estimate_friction_load(contacts, {}).has_value();
    with += estimate_friction_load(contacts, options).has_value();
  }
  EXPECT_GE(alone, 3);
  EXPECT_EQ(with, 0);
}

TEST(FrictionLoadEstimate, NeedsSeveralLoads) {
  std::vector<LoadedContact> contacts = probe_object({.exponent = -0.2}, {}, 1);
  for (LoadedContact& contact : contacts) {
    std::erase_if(contact.trials,
                  [](const FrictionTrial& trial) { return std::abs(trial.force.z() - 0.7) > 0.1; });
  }
  EXPECT_FALSE(estimate_friction_load(contacts, {}));
  EXPECT_FALSE(estimate_friction_load({}, {}));
}

// The law bends forces along the axis that is found; the coefficient is that at the reference.
TEST(FitFriction, FollowsALoadThatIsGiven) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const LoadedProbing with{.exponent = -0.15, .axis = Eigen::Vector3d(0.1, 0.05, 1).normalized()};
    const FrictionFit fit = fit_friction(probe_loaded(with, seed), kLoadedNormal,
                                         {.load = {.exponent = -0.15, .force = 1.5}});
    ASSERT_EQ(fit.stop, FrictionStop::converged);
    EXPECT_NEAR(fit.coefficient, 0.7 * std::pow(1.5, -0.15), 4 * fit.coefficient_error);
    EXPECT_LT(std::acos(std::min(1.0, fit.axis.dot(with.axis))), 0.02);
    EXPECT_LT(fit.noise, 0.02);
  }
}

// Errors of the force that are the same in all trials of a contact make every bound of a fit that
// knows only noise too high, as joints do whose friction takes off 0.02 N.
TEST(FitFriction, LowerBoundsHoldInSpiteOfASteadyError) {
  constexpr int kCount = 80;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  int noise_alone = 0, with_steady = 0;
  double squares = 0;
  for (unsigned seed = 0; seed < kCount; ++seed) {
    const LoadedProbing with{.friction = 0.9, .steady = 0.02 * normal(random), .directions = 6};
    const std::vector<FrictionTrial> trials = probe_loaded(with, seed);
    const FrictionFit fit = fit_friction(trials, kLoadedNormal, {.steady_error = 0.02});
    noise_alone += fit_friction(trials, kLoadedNormal).lower_bound <= 0.9;
    with_steady += fit.lower_bound <= 0.9;
    squares += std::pow((fit.coefficient - 0.9) / fit.coefficient_error, 2) / kCount;
    EXPECT_GT(fit.lower_bound, 0.8);
  }
  EXPECT_LT(noise_alone, 0.85 * kCount);
  EXPECT_GE(with_steady, 0.88 * kCount);  // 95 % less three standard deviations
  EXPECT_LT(squares, 1.3);
}

TEST(FitFriction, LowerBoundOfWhatNeverSlippedAllowsForASteadyError) {
  std::vector<FrictionTrial> trials;
  for (const double level : {1.0, 2.0}) {
    for (int i = 0; i < 12; ++i) {
      const double angle = std::numbers::pi * i / 6;
      trials.push_back(
          {level * Eigen::Vector3d(0.6 * std::cos(angle), 0.6 * std::sin(angle), 1), false});
    }
  }
  const FrictionOptions noise{.force_noise = 1e-4};
  const FrictionOptions steady{.force_noise = 1e-4, .steady_error = 0.02};
  const double before = fit_friction(trials, kLoadedNormal, noise).lower_bound;
  const double bound = fit_friction(trials, kLoadedNormal, steady).lower_bound;
  // 1.645 times 0.02 N at the load that tells most, 2 N.
  EXPECT_NEAR(before - bound, 1.645 * 0.02 / 2, 0.003);
}

}  // namespace
}  // namespace palpate::haptics
