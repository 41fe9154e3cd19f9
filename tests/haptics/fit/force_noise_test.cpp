// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/force_noise.h"

#include <gtest/gtest.h>

#include <random>

#include "palpate/core/quantile.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

// Pairs of springs of several stiffnesses [N/mm], with noise of the forces [N].
std::vector<ForceSamples> springs(double noise) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share(-1, 1);
  std::vector<ForceSamples> contacts;
  for (int c = 0; c < 8; ++c) {
    const Vector3d stiffness = (0.5 + 0.1 * c) * Vector3d(0.7, 0.8, 1);
    ForceSamples pairs;
    pairs.displacements.resize(3, 40);
    pairs.forces.resize(3, 40);
    for (int i = 0; i < 40; ++i) {
      const Vector3d x{share(random), share(random), 1 + share(random)};
      pairs.displacements.col(i) = x;
      pairs.forces.col(i) = stiffness.cwiseProduct(x) +
                            noise * Vector3d{normal(random), normal(random), normal(random)};
    }
    contacts.push_back(pairs);
  }
  return contacts;
}

// Springs are simple, so that few bases explain them.
const FitOptions kOptions{.noise = {.displacement = 1e-4}};

// Forces in another unit.
std::vector<ForceSamples> scaled(std::vector<ForceSamples> contacts, double factor) {
  for (ForceSamples& contact : contacts) contact.forces *= factor;
  return contacts;
}

// 0.4 % of the median of the largest forces.
double least_noise(const std::vector<ForceSamples>& contacts) {
  std::vector<double> largest;
  for (const ForceSamples& contact : contacts)
    largest.push_back(contact.forces.colwise().norm().maxCoeff());
  return 0.004 * median(largest);
}

TEST(EstimatedForceNoise, ExplainsTheErrorsOfTheFields) {
  EXPECT_NEAR(estimated_force_noise(springs(0.04), 0, kOptions), 0.04, 0.012);
  EXPECT_NEAR(estimated_force_noise(springs(0.15), 0, kOptions), 0.15, 0.045);
}

TEST(EstimatedForceNoise, IsInTheUnitOfTheForces) {
  for (const double factor : {0.1, 1e-3, 1e-9, 1e3}) {
    const std::vector<ForceSamples> contacts = springs(0.04);
    EXPECT_NEAR(estimated_force_noise(scaled(contacts, factor), 0, kOptions) / factor,
                estimated_force_noise(contacts, 0, kOptions), 1e-6);
  }
}

TEST(EstimatedForceNoise, IsInProportionToTheForcesWhereErrorsAreExpected) {
  FitOptions options = kOptions;
  options.max_bases = 1;
  EXPECT_NEAR(estimated_force_noise(springs(0.15), 0, options), least_noise(springs(0.15)), 1e-9);
  options = kOptions;
  options.accuracy = 0.1;
  EXPECT_NEAR(estimated_force_noise(springs(0.15), 0, options), least_noise(springs(0.15)), 1e-9);
}

TEST(EstimatedForceNoise, IsAtLeastWhatRepeatedForcesShow) {
  EXPECT_EQ(estimated_force_noise(springs(0.02), 0.02, kOptions), 0.02);
  EXPECT_NEAR(estimated_force_noise(springs(0.08), 0.02, kOptions), 0.08, 0.024);
  EXPECT_NEAR(estimated_force_noise(springs(0.001), 0.001, kOptions), least_noise(springs(0.001)),
              1e-9);
}

}  // namespace
}  // namespace palpate::haptics
