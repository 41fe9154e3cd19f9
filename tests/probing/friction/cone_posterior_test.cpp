// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/cone_posterior.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

// A cone drawn from the prior, and an arm whose applied forces err by its noise.
struct SimulatedContact {
  double angle;
  Vector3d axis;

  SimulatedContact(std::mt19937& random, const ConePrior& prior) {
    std::normal_distribution<double> normal;
    angle = std::max(0.05, prior.angle + prior.angle_deviation * normal(random));
    const double x = normal(random), y = normal(random);
    axis = Vector3d(prior.tilt_deviation * x, prior.tilt_deviation * y, 1).normalized();
  }
  [[nodiscard]] bool slips(const Vector3d& force) const {
    const double along = force.dot(axis);
    return (force - along * axis).norm() > std::tan(angle) * along;
  }
};

// Twelve trials, each where it slips with an even chance.
ConePosterior probed(const SimulatedContact& contact, const ConePrior& prior,
                     std::mt19937& random) {
  std::normal_distribution<double> noise(0, prior.force_noise);
  ConePosterior posterior(Vector3d::UnitZ(), prior);
  for (int i = 0; i < 12; ++i) {
    const double direction = 2.4 * i;
    const auto force = [&](double size) {
      return Vector3d(size * std::cos(direction), size * std::sin(direction), 1.5);
    };
    double low = 0, high = 2.6;
    while (high - low > 1e-3)
      (posterior.slip_probability(force((low + high) / 2)) < 0.5 ? low : high) = (low + high) / 2;
    const Vector3d applied = force(low) + Vector3d{noise(random), noise(random), noise(random)};
    const ConeTrial trial{force(low), contact.slips(applied)};
    posterior.add({&trial, 1});
  }
  return posterior;
}

TEST(ConePosterior, IsAsExactAsItSays) {
  const ConePrior prior{.angle = 0.7, .angle_deviation = 0.15, .tilt_deviation = 0.06};
  constexpr int kCount = 200;
  std::mt19937 random(7);
  double squares = 0, tilt_squares = 0;
  int inside = 0, above = 0;
  for (int i = 0; i < kCount; ++i) {
    const SimulatedContact contact(random, prior);
    const ConeEstimate found = probed(contact, prior, random).estimate();
    squares += std::pow((found.angle - contact.angle) / found.angle_deviation, 2) / kCount;
    tilt_squares += std::pow(found.axis.cross(contact.axis).norm() / found.axis_error, 2) / kCount;
    const double coefficient = std::tan(contact.angle);
    inside += found.low <= coefficient && coefficient <= found.high ? 1 : 0;
    above += contact.angle >= found.least_angle ? 1 : 0;
    EXPECT_LT(found.angle_deviation, 0.06);
  }
  // Of 200: the standard deviation of the mean of squares is 0.1, of a count at 95 % it is 3.
  // The grid and the assumed lapses widen the distribution.
  EXPECT_GT(squares, 0.4);
  EXPECT_LT(squares, 1.3);
  EXPECT_GT(tilt_squares, 0.4);
  EXPECT_LT(tilt_squares, 1.3);
  EXPECT_GE(inside, 0.95 * kCount - 9);
  EXPECT_GE(above, 0.95 * kCount - 9);
}

TEST(ConePosterior, PredictsTheShareOfSlips) {
  const ConePrior prior{.angle = 0.7, .angle_deviation = 0.15, .tilt_deviation = 0.06};
  std::mt19937 random(3);
  const ConePosterior posterior(Vector3d::UnitZ(), prior);
  const Vector3d force(1.1, 0.4, 1.5);
  constexpr int kCount = 4000;
  int slips = 0;
  for (int i = 0; i < kCount; ++i) slips += SimulatedContact(random, prior).slips(force) ? 1 : 0;
  // The deviation of the share is 0.008; the grid has steps of half a deviation.
  EXPECT_NEAR(posterior.slip_probability(force), slips / double{kCount}, 0.03);
}

TEST(ConePosterior, WithoutTrialsIsThePrior) {
  const ConeEstimate found =
      ConePosterior({0, 0, 3}, {.angle = 0.6, .angle_deviation = 0.1}).estimate();
  EXPECT_NEAR(found.angle, 0.6, 1e-3);
  EXPECT_NEAR(found.angle_deviation, 0.1, 3e-3);
  EXPECT_NEAR(found.least_angle, 0.6 - 1.645 * 0.1, 0.01);
}

TEST(ConePosterior, TurnsWithTheForces) {
  std::mt19937 random(5);
  const ConePrior prior;
  const SimulatedContact contact(random, prior);
  const Eigen::Matrix3d turn = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized().matrix();
  std::vector<ConeTrial> trials, turned;
  for (int i = 0; i < 30; ++i) {
    const Vector3d force(1.9 * std::sin(2.4 * i), (0.5 + 0.05 * i) * std::cos(2.4 * i), 1.3);
    trials.push_back({force, contact.slips(force)});
    turned.push_back({turn * force, trials.back().slipped});
  }
  ConePosterior a(Vector3d::UnitZ(), prior), b(turn.col(2), prior);
  a.add(trials);
  b.add(turned);
  // The grids lie differently about the axis.
  EXPECT_NEAR(a.estimate().angle, b.estimate().angle, 0.3 * a.estimate().angle_deviation);
  EXPECT_LT((turn * a.estimate().axis - b.estimate().axis).norm(), 0.3 * a.estimate().axis_error);
}

TEST(ConePosterior, RefusesNumbersOutOfRange) {
  EXPECT_THROW(ConePosterior({0, 0, 0}), InvalidInput);
  EXPECT_THROW(ConePosterior({0, 0, 1}, {.angle = 2}), InvalidInput);
  EXPECT_THROW(ConePosterior({0, 0, 1}, {.tilt_deviation = 0}), InvalidInput);
  EXPECT_THROW(ConePosterior({0, 0, 1}, {.force_noise = 0}), InvalidInput);
}

}  // namespace
}  // namespace palpate::probing
