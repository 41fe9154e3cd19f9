// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/friction_cone.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

const Eigen::Vector3d kNormal(0, 0, -1);
const Eigen::Vector3d kAxis = Eigen::Vector3d(0.1, -0.05, 0.9).normalized();
constexpr double kForceNoise = 0.01;

struct ConeProbing {
  double friction = 0.7;
  Eigen::Vector3d axis = kAxis;
  int directions = 8;
  double range = 2 * std::numbers::pi;  ///< [rad] that the directions are spread over
  std::vector<double> levels = {0.15, 0.5, 1.1, 2, 3};
  double noise = kForceNoise;
  double mistaken = 0;  ///< part of the trials whose slip is told wrongly
  double most = 3.3;    ///< [N] tangential force tried first
};

// The trials of an arm that presses along the geometric normal and halves the interval of the
// tangential force in each direction to 0.05 N (thesis 4.3). Independent of the fit: the physical
// condition |f_T| > friction f_N with noise on each component of the force.
std::vector<FrictionTrial> probe(const ConeProbing& with, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, with.noise);
  std::uniform_real_distribution<double> uniform;
  std::vector<FrictionTrial> trials;
  const auto slips = [&](const Eigen::Vector3d& force) {
    const Eigen::Vector3d f = force + Eigen::Vector3d{noise(random), noise(random), noise(random)};
    const double along = f.dot(with.axis);
    const bool slipped = (f - along * with.axis).norm() > with.friction * along;
    trials.push_back({force, slipped != (uniform(random) < with.mistaken)});
    return trials.back().slipped;
  };
  const double first = 2 * std::numbers::pi * uniform(random);
  for (const double level : with.levels) {
    trials.push_back({-level * kNormal, false});
    for (int i = 0; i < with.directions; ++i) {
      const double angle = first + with.range * i / with.directions;
      const Eigen::Vector3d across(std::cos(angle), std::sin(angle), 0);
      const auto slips_at = [&](double size) { return slips(size * across - level * kNormal); };
      double low = 0, high = with.most;
      if (!slips_at(high)) continue;
      while (high - low > 0.05) (slips_at((low + high) / 2) ? high : low) = (low + high) / 2;
    }
  }
  return trials;
}

double angle_to_axis(const FrictionFit& fit) {
  return std::atan2(fit.axis.cross(kAxis).norm(), fit.axis.dot(kAxis));
}

double quantile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size()))];
}

// The trials of a campaign with pooled friction: in each direction at each level one force near the
// boundary, as far as it is known, and sometimes a second one.
std::vector<FrictionTrial> probe_without_searching(const ConeProbing& with, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, with.noise), place(0, 0.05);
  std::uniform_real_distribution<double> uniform;
  std::vector<FrictionTrial> trials;
  const double first = 2 * std::numbers::pi * uniform(random);
  for (std::size_t level = 0; level < with.levels.size(); ++level) {
    for (int i = 0; i < with.directions; ++i) {
      const double angle =
          first + 0.7 * static_cast<double>(level) + 2 * std::numbers::pi * i / with.directions;
      const double size = with.levels[level] * with.friction * (1 + place(random));
      const Eigen::Vector3d force = size * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0) -
                                    with.levels[level] * kNormal;
      const Eigen::Vector3d f =
          force + Eigen::Vector3d{noise(random), noise(random), noise(random)};
      const double along = f.dot(with.axis);
      trials.push_back({force, (f - along * with.axis).norm() > with.friction * along});
    }
  }
  return trials;
}

TEST(FitFriction, TakesTrialsWithoutSearchesAsTheyAre) {
  constexpr int kCount = 100;
  std::vector<double> errors;
  int inside = 0, held = 0;
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (unsigned i = 0; i < kCount; ++i) {
    // Cones that differ as those of one object do, and that the others have told (pooled_prior).
    ConeProbing with{
        .friction = std::tan(0.7 + 0.04 * normal(random)),
        .axis = Eigen::Vector3d{0.05 * normal(random), 0.05 * normal(random), 1}.normalized(),
        .directions = 4,
        .levels = {0.7, 1.4, 1.8}};
    const FrictionFit fit =
        fit_friction(probe_without_searching(with, i), kNormal,
                     {.prior = {.angle = 0.7, .angle_deviation = 0.05, .tilt_deviation = 0.06}});
    ASSERT_EQ(fit.stop, FrictionStop::converged) << i;
    EXPECT_TRUE(fit.uses_prior);
    errors.push_back(std::abs(fit.coefficient - with.friction));
    inside += errors.back() <= 1.96 * fit.coefficient_error ? 1 : 0;
    held += fit.lower_bound <= with.friction ? 1 : 0;
  }
  // Half of what the prior alone would give: 1.96 * 0.04 rad * (1 + 0.84^2) = 0.134.
  EXPECT_LE(quantile(errors, 0.95), 0.067);
  // 95 % less three standard deviations of a count of 100.
  EXPECT_GE(inside, 88);
  EXPECT_GE(held, 88);
}

TEST(FitFriction, WithoutSearchesTellsThatTooLittleWasTried) {
  std::vector<FrictionTrial> few = {{{0.1, 0, 1}, false}, {{2.5, 0, 1}, true}};
  const FrictionFit fit = fit_friction(few, kNormal);
  EXPECT_EQ(fit.stop, FrictionStop::too_few_directions);
  EXPECT_EQ(fit.coefficient, 0);
  EXPECT_EQ(fit.axis, Eigen::Vector3d(-kNormal));
}

TEST(FitFriction, IsAsExactAsItsErrorsSayAndItsLowerBoundHolds) {
  constexpr int kCount = 300;
  std::vector<double> errors, angles;
  double squares = 0, angle_squares = 0;
  int held = 0;
  for (unsigned i = 0; i < kCount; ++i) {
    const ConeProbing with{.friction = 0.2 + i / double{kCount}, .directions = 8 + int(i) % 5};
    const FrictionFit fit = fit_friction(probe(with, i), kNormal);
    ASSERT_EQ(fit.stop, FrictionStop::converged) << i;
    errors.push_back(std::abs(fit.coefficient - with.friction));
    angles.push_back(angle_to_axis(fit));
    squares += std::pow(errors.back() / fit.coefficient_error, 2) / kCount;
    angle_squares += std::pow(angles.back() / fit.axis_error, 2) / kCount;
    held += fit.lower_bound <= with.friction ? 1 : 0;
    EXPECT_LT(fit.lower_bound, fit.coefficient);
  }
  EXPECT_LE(quantile(errors, 0.95), 0.01);
  EXPECT_LE(quantile(angles, 0.95), 0.5 * std::numbers::pi / 180);
  // Means of 300 squares of standard normal numbers and half as many chi^2 of two: 1 +- 0.08.
  EXPECT_NEAR(squares, 1, 0.35);
  EXPECT_NEAR(angle_squares, 1, 0.35);
  // 95 % less three standard deviations of a count of 300.
  EXPECT_GE(held, 0.912 * kCount);
}

TEST(FitFriction, StaysWithTheMajorityAgainstMistakenSlips) {
  std::vector<double> errors;
  for (unsigned i = 0; i < 100; ++i) {
    const FrictionFit fit = fit_friction(probe({.mistaken = 0.03}, i), kNormal);
    EXPECT_EQ(fit.stop, FrictionStop::converged);
    errors.push_back(std::abs(fit.coefficient - 0.7));
  }
  EXPECT_LE(quantile(errors, 0.95), 0.01);
}

TEST(FitFriction, EstimatesMoreNoiseThanItWasTold) {
  const FrictionFit fit =
      fit_friction(probe({.directions = 24, .noise = 0.04}, 3), kNormal, {.force_noise = 0.01});
  EXPECT_NEAR(fit.noise, 0.04, 0.015);
}

TEST(FitFriction, TurnsWithTheForcesScalesWithThemAndTakesThemInAnyOrder) {
  std::vector<FrictionTrial> trials = probe({}, 5);
  const FrictionFit fit = fit_friction(trials, kNormal);
  EXPECT_EQ(fit.vectors, 40);
  EXPECT_EQ(fit.directions, 8);
  EXPECT_EQ(fit.levels, 5);
  for (FrictionTrial& trial : trials) trial.force = 0x1p-20 * some_rotation() * trial.force;
  std::shuffle(trials.begin(), trials.end(), std::mt19937(1));
  const FrictionFit turned =
      fit_friction(trials, some_rotation() * kNormal, {.force_noise = 0x1p-20 * kForceNoise});
  // The accuracy of the search, well below the standard errors of 0.002.
  constexpr double kEnd = 1e-5;
  EXPECT_LT((turned.axis - some_rotation() * fit.axis).norm(), kEnd);
  EXPECT_NEAR(turned.coefficient, fit.coefficient, kEnd);
  EXPECT_NEAR(turned.coefficient_error, fit.coefficient_error, kEnd);
  EXPECT_NEAR(turned.lower_bound, fit.lower_bound, 1e-4);
  EXPECT_NEAR(turned.noise, 0x1p-20 * fit.noise, 0x1p-20 * kEnd);
  EXPECT_EQ(turned.vectors, fit.vectors);
}

TEST(FitFriction, SaysWhenTheTrialsDoNotDetermineACone) {
  EXPECT_EQ(fit_friction({}, kNormal).stop, FrictionStop::never_slipped);
  EXPECT_EQ(fit_friction({}, kNormal).lower_bound, 0);
  EXPECT_EQ(fit_friction(probe({.directions = 2}, 1), kNormal).stop,
            FrictionStop::too_few_directions);
  EXPECT_EQ(fit_friction(probe({.range = 0.3}, 1), kNormal).stop, FrictionStop::too_few_directions);
  EXPECT_EQ(fit_friction(probe({.levels = {1.1}}, 1), kNormal).stop, FrictionStop::too_few_levels);
  EXPECT_EQ(fit_friction(probe({.range = 4.5}, 1), kNormal).stop, FrictionStop::converged);
}

TEST(FitFriction, RecognisesAContactWithoutFriction) {
  for (unsigned i = 0; i < 10; ++i) {
    const ConeProbing without{.friction = 0, .axis = -kNormal};
    const FrictionFit fit = fit_friction(probe(without, i), kNormal);
    EXPECT_EQ(fit.stop, FrictionStop::frictionless);
    EXPECT_LT(fit.coefficient, 0.01);
    EXPECT_LT(fit.lower_bound, 0.004);
    const ConeProbing some{.friction = 0.05, .axis = -kNormal};
    EXPECT_EQ(fit_friction(probe(some, i), kNormal).stop, FrictionStop::converged);
  }
}

TEST(FitFriction, FindsTheConeWhereTheNoiseIsFarBelowTheBisection) {
  for (unsigned i = 0; i < 100; ++i) {
    const FrictionFit fit = fit_friction(probe({.noise = 0.001}, i), kNormal, {0.001});
    EXPECT_EQ(fit.stop, FrictionStop::converged) << i;
    EXPECT_NEAR(fit.coefficient, 0.7, 0.01) << i;
  }
}

TEST(FitFriction, BoundsWhatNeverSlippedByTheNarrowestConeAroundIt) {
  constexpr double kHeld = 0.6;
  const Eigen::Vector3d x = kAxis.unitOrthogonal(), y = kAxis.cross(x);
  std::vector<FrictionTrial> trials;
  for (const double level : {1.0, 2.0, 3.0}) {
    for (int i = 0; i < 12; ++i) {
      const double angle = std::numbers::pi * i / 6;
      trials.push_back(
          {level * (kAxis + kHeld * (std::cos(angle) * x + std::sin(angle) * y)), false});
    }
  }
  const FrictionFit fit = fit_friction(trials, kNormal, {.force_noise = 1e-4});
  EXPECT_EQ(fit.stop, FrictionStop::never_slipped);
  EXPECT_NEAR(fit.lower_bound, kHeld, 1e-3);  // a few times the noise
}

TEST(FitFriction, BoundsWhatTooFewDirectionsLeaveOpen) {
  constexpr int kCount = 200;
  int held = 0;
  double sum = 0;
  for (unsigned i = 0; i < kCount; ++i) {
    const FrictionFit fit = fit_friction(probe({.directions = 3}, i), kNormal);
    EXPECT_EQ(fit.stop, FrictionStop::too_few_directions);
    held += fit.lower_bound <= 0.7 ? 1 : 0;
    sum += fit.lower_bound;
  }
  // 95 % less three standard deviations of a count of 200.
  EXPECT_GE(held, 0.904 * kCount);
  EXPECT_GE(sum, 0.68 * kCount);
}

// The forces are a few times the noise: the lower bound is no more than that, and the coefficient
// is anything.
TEST(FitFriction, CallsNoWideConeFrictionless) {
  int open = 0;
  for (unsigned i = 0; i < 40; ++i) {
    const FrictionFit fit =
        fit_friction(probe({.levels = {0.02, 0.03}, .noise = 0.01, .most = 0.1}, i), kNormal);
    EXPECT_NE(fit.stop, FrictionStop::frictionless) << fit.coefficient;
    open += fit.lower_bound * 0.03 <= kForceNoise ? 1 : 0;
  }
  EXPECT_GT(open, 5);
}

TEST(FitFriction, RefusesWhatIsNotFinite) {
  std::vector<FrictionTrial> trials = probe({}, 1);
  EXPECT_THAT(refusal([&] {
                return fit_friction(trials, {0, 0, 0});
              }),
              ::testing::HasSubstr("normal"));
  EXPECT_THAT(refusal([&] { return fit_friction(trials, kNormal, {.force_noise = 0}); }),
              ::testing::HasSubstr("force_noise"));
  // A noise and forces whose squares overflow would be cooled for ever.
  EXPECT_THAT(refusal([&] { return fit_friction(trials, kNormal, {.force_noise = 1e155}); }),
              ::testing::HasSubstr("force_noise"));
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), 1e13, 1e155, -1e300}) {
    trials[6].force.y() = bad;
    EXPECT_THAT(refusal([&] { return fit_friction(trials, kNormal); }),
                ::testing::HasSubstr("trial 6"));
  }
}

const probing::Contact kTriedContact{1, {0, 0, 700}, {0, 0, -1}};

probing::Sample tried_sample(long long contact, const Eigen::Vector3d& force, bool held) {
  return {.id = 0,
          .contact = contact,
          .group = 1,
          .force = force,
          .a = {0, 0, 0},
          .b = kTriedContact.position + 2 * force,
          .on_friction_boundary = held,
          .slipped = !held};
}

TEST(FrictionTrials, AreTheSamplesOfTheContact) {
  const std::vector<probing::Sample> samples = {tried_sample(1, {1, 0, 2}, true),
                                                tried_sample(9, {1, 0, 2}, true),
                                                tried_sample(1, {1.5, 0, 2}, false)};
  const std::vector<FrictionTrial> trials = friction_trials(kTriedContact, samples);
  ASSERT_EQ(trials.size(), 2u);
  EXPECT_FALSE(trials[0].slipped);
  EXPECT_TRUE(trials[1].slipped);
  EXPECT_EQ(trials[1].force, Eigen::Vector3d(1.5, 0, 2));
}

}  // namespace
}  // namespace palpate::haptics
