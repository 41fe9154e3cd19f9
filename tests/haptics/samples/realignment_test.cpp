// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/realignment.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "samples/repeated_forces.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

const probing::Contact kContact{4, {10, 20, 700}, {0, 0, -1}};

probing::Sample sample(long long group, const Vector3d& force, const Vector3d& a, const Vector3d& b,
                       bool slipped = false) {
  return {
      .id = 0, .contact = 4, .group = group, .force = force, .a = a, .b = b, .slipped = slipped};
}

TEST(Realign, MovesEachGroupOntoItsMean) {
  const std::vector<probing::Sample> samples = {
      sample(7, {0.5, 0, 2}, {10.1, 20, 703}, {12.1, 20, 703.5}),
      sample(7, {0, 0.5, 2}, {9.9, 20.2, 703.4}, {9.9, 23.2, 704})};
  const ForceSamples pairs = realign(kContact, samples);
  ASSERT_EQ(pairs.forces.cols(), 3);
  const Vector3d mean(0, 0.1, 3.2);  // of a, from the contact
  EXPECT_TRUE(pairs.displacements.col(0).isApprox(mean, 1e-12));
  EXPECT_TRUE(pairs.displacements.col(1).isApprox(mean + Vector3d(2, 0, 0.5), 1e-12));
  EXPECT_TRUE(pairs.displacements.col(2).isApprox(mean + Vector3d(0, 3, 0.6), 1e-12));
  EXPECT_TRUE(pairs.forces.col(0).isApprox(Vector3d(0, 0, 2)));
  EXPECT_EQ(pairs.forces.col(1), Vector3d(0.5, 0, 2));
}

TEST(Realign, TakesOnlyTheFirstPositionOfASampleThatSlipped) {
  const std::vector<probing::Sample> samples = {
      sample(1, {1, 0, 2}, {10, 20, 704}, {1e6, 1e6, 1e6}, true),
      sample(1, {0, 0, 2}, {10, 20, 702}, {10, 20, 702})};
  const ForceSamples pairs = realign(kContact, samples);
  ASSERT_EQ(pairs.forces.cols(), 1);
  EXPECT_EQ(pairs.displacements.col(0), Vector3d(0, 0, 3));
}

TEST(Realign, CountsASampleWithoutATangentialStageOnce) {
  // Of a group without any, the whole force is that of the settled position.
  std::vector<probing::Sample> samples = {sample(1, {0.5, 0, 2}, {10, 20, 704}, {10, 20, 704}),
                                          sample(1, {0.7, 0, 2}, {10, 20, 702}, {10, 20, 702})};
  ForceSamples pairs = realign(kContact, samples);
  ASSERT_EQ(pairs.forces.cols(), 1);
  EXPECT_EQ(pairs.displacements.col(0), Vector3d(0, 0, 3));
  EXPECT_TRUE(pairs.forces.col(0).isApprox(Vector3d(0.6, 0, 2), 1e-12));
  EXPECT_EQ(pairs.kinds, std::vector{PairKind::settled});
  // Beside one that has, only that one makes a pair of its own.
  samples.push_back(sample(1, {1, 0, 2}, {10, 20, 703}, {11, 20, 703}));
  pairs = realign(kContact, samples);
  ASSERT_EQ(pairs.forces.cols(), 2);
  EXPECT_TRUE(pairs.forces.col(0).isApprox(Vector3d(0, 0, 2), 1e-12));
  EXPECT_TRUE(pairs.displacements.col(1).isApprox(Vector3d(1, 0, 3), 1e-12));
}

TEST(Realign, KeepsGroupsAndContactsApart) {
  std::vector<probing::Sample> samples = {sample(2, {0, 0, 1}, {10, 20, 701}, {10, 20, 701}),
                                          sample(1, {0, 0, 3}, {10, 20, 705}, {10, 20, 705}),
                                          sample(1, {0, 0, 3}, {0, 0, 0}, {0, 0, 0})};
  samples.back().contact = 5;
  const ForceSamples pairs = realign(kContact, samples);
  ASSERT_EQ(pairs.forces.cols(), 2);
  EXPECT_EQ(pairs.displacements.row(2), Eigen::RowVector2d(5, 1));
  EXPECT_EQ(pairs.forces.row(2), Eigen::RowVector2d(3, 1));
}

// Positions that scatter by `noise` in all directions, and by ten times that along z.
std::vector<probing::Sample> scattered(double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noise);
  std::vector<probing::Sample> samples;
  for (int i = 0; i < 200; ++i) {
    const Vector3d off{normal(random), normal(random), 10 * normal(random)};
    const Vector3d a = Vector3d(10, 20, 703) + off;
    samples.push_back(sample(i / 50, {0, 0, 2}, a, a));
  }
  return samples;
}

TEST(Realign, EstimatesTheNoiseFromWhereGroupsScatterLeast) {
  const ForceSamples pairs = realign(kContact, scattered(0.02, 1));
  EXPECT_EQ(pairs.degrees_of_freedom, 4 * 49);
  const double noise = 0.02;
  EXPECT_NEAR(*pairs.displacement_noise, noise, 0.15 * noise);
  const ForceSamples few =
      realign(kContact, std::vector{sample(1, {0, 0, 2}, {10, 20, 703}, {10, 20, 703})});
  EXPECT_EQ(few.degrees_of_freedom, 0);
  EXPECT_EQ(few.displacement_noise, std::nullopt);
  EXPECT_EQ(pooled_displacement_noise(std::vector{few, few}), std::nullopt);
  EXPECT_NEAR(*pooled_displacement_noise(std::vector{few, pairs, few}), *pairs.displacement_noise,
              1e-15);
}

TEST(Realign, LeavesOutliersOutOfTheMean) {
  std::vector<probing::Sample> samples = scattered(0.002, 2);
  const ForceSamples clean = realign(kContact, samples);
  samples[7].a.x() += 1;
  samples[7].slipped = true;
  const ForceSamples pairs = realign(kContact, samples);
  EXPECT_LT((pairs.displacements.col(0) - clean.displacements.col(0)).norm(), 0.002);
  EXPECT_NEAR(*pairs.displacement_noise, *clean.displacement_noise,
              0.1 * *clean.displacement_noise);
}

// Groups of `size` with the same noise in all directions.
std::vector<probing::Sample> alike(int groups, int size, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 0.02);
  std::vector<probing::Sample> samples;
  for (int i = 0; i < groups * size; ++i) {
    const Vector3d a =
        Vector3d(10, 20, 703) + Vector3d{normal(random), normal(random), normal(random)};
    samples.push_back(sample(i / size, {0, 0, 2}, a, a));
  }
  return samples;
}

TEST(Realign, EstimatesTheNoiseFromGroupsOfAnySize) {
  constexpr int kPositions = 32000;
  for (const int size : {4, 5, 8, 16, 49}) {
    const ForceSamples pairs = realign(kContact, alike(kPositions / size, size, 5));
    EXPECT_NEAR(*pairs.displacement_noise, 0.02, 0.03 * 0.02) << size;
  }
}

// The touch varies along the surface, but is the same for a and b of a sample.
TEST(Realign, UnderstatesTheNoiseOfPairsOnARigidObjectByRootTwoAtMost) {
  std::mt19937 random(6);
  std::normal_distribution<double> normal(0, 0.02);
  const auto noise = [&] { return Vector3d{normal(random), normal(random), normal(random)}; };
  std::vector<probing::Sample> samples;
  for (int i = 0; i < 40 * 49; ++i) {
    const Vector3d place = Vector3d(10, 20, 700) + Vector3d{normal(random), normal(random), 0};
    samples.push_back(sample(i / 49, {0, 0, 2}, place + noise(), place + noise()));
  }
  const ForceSamples pairs = realign(kContact, samples);
  const double true_noise = std::sqrt(pairs.displacements.squaredNorm() /
                                      static_cast<double>(pairs.displacements.size()));
  const double ratio = true_noise / *pairs.displacement_noise;
  EXPECT_GT(ratio * ratio, 1);  // chi^2 of the true field
  EXPECT_LT(ratio * ratio, 2.1);
}

TEST(Realign, FindsAnOutlierInASmallGroup) {
  for (const int size : {4, 5, 6, 7, 8, 12}) {
    std::vector<probing::Sample> samples = alike(100, size, 8);
    for (std::size_t group = 0; group < 100; ++group) {
      probing::Sample& wrong = samples[group * static_cast<std::size_t>(size) + group % 3];
      wrong.a.x() += 1;
      wrong.force.z() = 50;
      wrong.slipped = true;
    }
    const ForceSamples pairs = realign(kContact, samples);
    if (size > 4) {  // else too few are left
      EXPECT_NEAR(*pairs.displacement_noise, 0.02, 0.2 * 0.02) << size;
    }
    Eigen::Index pair = 0;
    for (int group = 0; group < 100; ++group, ++pair) {  // without tangential stages: one each
      EXPECT_LT((pairs.displacements.col(pair) - Vector3d(0, 0, 3)).norm(), 0.1) << size;
      EXPECT_TRUE(pairs.forces.col(pair).isApprox(Vector3d(0, 0, 2), 1e-12)) << size;
    }
  }
}

TEST(Realign, OfNothingIsNothing) { EXPECT_EQ(realign(kContact, {}).forces.cols(), 0); }

// An object that hardens, pressed 400 times to each of four forces, with noise of the force that is
// applied but not recorded, and of the force that is recorded but not applied.
std::vector<probing::Sample> repeated_presses(double applied, double recorded, double factor = 1) {
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  const auto depth = [](double force) { return 2 * std::log1p(force); };
  std::vector<probing::Sample> samples;
  for (const double level : {0.3, 0.8, 1.5, 3.0}) {
    for (int i = 0; i < 400; ++i) {
      const Vector3d at(10, 20, 700 + depth(level + applied * normal(random)));
      samples.push_back(sample(static_cast<long long>(10 * level),
                               {0, 0, factor * (level + recorded * normal(random))}, at,
                               at + Vector3d(0.1, 0, 0)));
    }
  }
  return samples;
}

TEST(RepeatedForces, TellTheirNoiseInTheUnitOfTheForces) {
  const std::vector<RepeatedForce> groups = repeated_forces(kContact, repeated_presses(0.01, 0.02));
  ASSERT_EQ(groups.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const double level = std::array{0.3, 0.8, 1.5, 3.0}[i], stiffness = (1 + level) / 2;
    EXPECT_EQ(groups[i].degrees_of_freedom, 399);
    EXPECT_NEAR(groups[i].stiffness, stiffness, 0.25 * stiffness);
    EXPECT_NEAR(std::sqrt(groups[i].variance), std::hypot(0.01, 0.02), 0.003);
  }
  for (const double factor : {1.0, 1e-3, 1e3}) {
    const auto scaled = repeated_forces(kContact, repeated_presses(0.01, 0.02, factor));
    EXPECT_NEAR(repeated_force_noise(scaled, 1e-4) / factor, std::hypot(0.01, 0.02), 0.002);
  }
}

TEST(RepeatedForces, TellNothingIfPositionsExplainTheirScatter) {
  EXPECT_EQ(repeated_force_noise({}, 0.02), 0);
  EXPECT_EQ(repeated_force_noise(repeated_forces(kContact, repeated_presses(0, 0)), 0.02), 0);
  EXPECT_EQ(repeated_force_noise(repeated_forces(kContact, repeated_presses(0.01, 0)), 0.03), 0);
}

}  // namespace
}  // namespace palpate::haptics
