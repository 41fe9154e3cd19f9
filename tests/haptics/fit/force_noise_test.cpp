// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/force_noise.h"

#include <gtest/gtest.h>

#include <random>

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
      const Vector3d x(share(random), share(random), 1 + share(random));
      pairs.displacements.col(i) = x;
      pairs.forces.col(i) = stiffness.cwiseProduct(x) +
                            noise * Vector3d(normal(random), normal(random), normal(random));
    }
    contacts.push_back(pairs);
  }
  return contacts;
}

// Springs are simple, so that few bases explain them.
const FitOptions kOptions{.noise = {.displacement = 1e-4, .force = 0.01}};

TEST(EstimatedForceNoise, IsThatOfTheDataWhereItIsMoreThanTold) {
  EXPECT_EQ(estimated_force_noise(springs(0.01), kOptions), 0.01);
  EXPECT_NEAR(estimated_force_noise(springs(0.04), kOptions), 0.04, 0.012);
  EXPECT_NEAR(estimated_force_noise(springs(0.15), kOptions), 0.15, 0.045);
}

TEST(EstimatedForceNoise, IsAsToldWhereErrorsAreExpected) {
  FitOptions options = kOptions;
  options.max_bases = 1;
  EXPECT_EQ(estimated_force_noise(springs(0.15), options), 0.01);
  options = kOptions;
  options.accuracy = 0.1;
  EXPECT_EQ(estimated_force_noise(springs(0.15), options), 0.01);
  EXPECT_EQ(estimated_force_noise({}, kOptions), 0.01);
}

}  // namespace
}  // namespace palpate::haptics
