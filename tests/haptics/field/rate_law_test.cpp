// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/rate_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

// Of values near 1 after some tens of operations.
constexpr double kRateRounding = 1e-12;

TEST(DisplacementAhead, FollowsARampAndARestAsAMaxwellElementDoes) {
  constexpr double kSpeed = 2.7, kTime = 0.13;  // [mm/s], [s]
  ToolHistory path{.time = {0.2, 0.25, 0.7, 0.9, 1.6},
                   .displacements = Eigen::Matrix3Xd::Zero(3, 5),
                   .begins = {true, false, false, false, false}};
  const double touched = 0.1;  // [s] the tool comes at a constant speed
  for (Eigen::Index k = 0; k < 5; ++k)
    path.displacements(2, k) =
        kSpeed * (std::min(path.time[static_cast<std::size_t>(k)], 0.9) - touched);
  const Eigen::Matrix3Xd ahead = displacement_ahead(path, kTime);
  for (Eigen::Index k = 0; k < 4; ++k) {
    const double since = path.time[static_cast<std::size_t>(k)] - touched;
    EXPECT_NEAR(ahead(2, k), kSpeed * kTime * -std::expm1(-since / kTime), kRateRounding) << k;
  }
  EXPECT_NEAR(ahead(2, 4), ahead(2, 3) * std::exp(-(1.6 - 0.9) / kTime), kRateRounding);
  EXPECT_TRUE(ahead.topRows<2>().isZero(0));
}

TEST(DisplacementAhead, OfAPathThatBeginsAtItsDeepestIsAllOfIt) {
  const ToolHistory path{.time = {3, 3.5, 9, 9.1},
                         .displacements = (Eigen::Matrix3Xd(3, 4) << 1, 1, 1, 1,  //
                                           0, 0, 0, 0,                            //
                                           2, 2, 1, 0.5)
                                              .finished(),
                         .begins = {true, false, true, false}};
  const Eigen::Matrix3Xd ahead = displacement_ahead(path, 0.7);
  EXPECT_EQ(ahead.col(0), path.displacements.col(0));
  EXPECT_NEAR((ahead.col(1) - std::exp(-0.5 / 0.7) * path.displacements.col(0)).norm(), 0,
              kRateRounding);
  EXPECT_EQ(ahead.col(2), path.displacements.col(2));
}

TEST(Relax, LetsTheDelayedDisplacementsFollowExactly) {
  const std::vector<RateTerm> terms = {{0.3, 0.05}, {0.2, 0.9}};
  const Eigen::Vector3d displacement(0.3, -1.2, 2.7);
  DelayedDisplacements once, often;
  relax(terms, displacement, 0.4, once);
  for (int i = 0; i < 400; ++i) relax(terms, displacement, 1e-3, often);
  for (std::size_t i = 0; i < 2; ++i) {
    const Eigen::Vector3d truth = -std::expm1(-0.4 / terms[i].time) * displacement;
    EXPECT_NEAR((once.of[i] - truth).norm(), 0, kRateRounding);
    EXPECT_NEAR((often.of[i] - truth).norm(), 0, 1e3 * kRateRounding);
  }
  const DelayedDisplacements before = once;
  relax(terms, displacement, 0, once);
  relax(terms, displacement, -1, once);
  relax(terms, displacement, std::nan(""), once);
  EXPECT_EQ(once.of, before.of);
}

// A smooth random motion: sums of sines of up to 3 Hz, some mm.
struct RandomMotion {
  explicit RandomMotion(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (Eigen::Vector3d& size : sizes)
      size = Eigen::Vector3d::NullaryExpr([&] { return uniform(random); });
    for (double& phase : phases) phase = std::numbers::pi * uniform(random);
  }
  [[nodiscard]] Eigen::Vector3d at(double time) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < 5; ++i) {
      const double omega = 2 * std::numbers::pi * 0.6 * static_cast<double>(i + 1);
      sum += sizes[i] * (std::sin(omega * time + phases[i]) - std::sin(phases[i]));
    }
    return sum;
  }
  std::array<Eigen::Vector3d, 5> sizes;
  std::array<double, 5> phases{};
};

// Work by quadrature of the force over the motion, against no formula of the energy.
TEST(RateLaw, GivesNoEnergyOnAnyPathFromRest) {
  const ForceField field = {{{4, 3}, {2, 1, {0.4, -0.2, 2.5}}, {1.5, 2, {0, 0, 1}, {0, 0, 1}}}};
  const std::vector<RateTerm> terms = {{0.9, 0.03}, {1.7, 0.4}};
  double least = 0, given_back = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const RandomMotion motion(seed);
    constexpr double kStep = 5e-4;  // [s]
    std::array<Eigen::Vector3d, 2> delayed = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    double work = 0, most = 0;
    for (int k = 0; k < 4000; ++k) {
      const Eigen::Vector3d from = motion.at(k * kStep), to = motion.at((k + 1) * kStep);
      const Eigen::Vector3d middle = (from + to) / 2;
      Eigen::Vector3d f = force(field, middle);
      for (std::size_t i = 0; i < 2; ++i) {  // midpoint rule, by itself
        const Eigen::Vector3d half = delayed[i] + kStep / 2 * (from - delayed[i]) / terms[i].time;
        f += terms[i].share * force(field, middle - half);
        delayed[i] += kStep * (middle - half) / terms[i].time;
      }
      work += f.dot(to - from);
      most = std::max(most, work);
      least = std::min(least, work);
    }
    given_back = std::max(given_back, most - work);
  }
  EXPECT_GT(given_back, 1);  // [N mm] the object is elastic, too
  EXPECT_GT(least, -1e-4);   // [N mm] of the quadrature
}

}  // namespace
}  // namespace palpate::haptics
