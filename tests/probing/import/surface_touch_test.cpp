// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/surface_touch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "palpate/probing/closed_form.h"

namespace palpate::probing {
namespace {

constexpr double kThreshold = 0.1;  // [N]
const Eigen::Vector3d kAlong = Eigen::Vector3d(0.6, 0, -0.8);

/// A press whose depth under a force is known; the surface is at the origin.
std::optional<TouchDepth> depth_of(const std::function<double(double)>& depth, double highest = 0.5,
                                   double noise = 0, unsigned seed = 1, int count = 20) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noise);
  std::vector<Eigen::Vector3d> tips;
  std::vector<double> forces;
  for (int i = 0; i < count; ++i) {
    const double force = kThreshold + (highest - kThreshold) * i / (count - 1);
    tips.push_back(depth(force) * kAlong);
    forces.push_back(force + (noise > 0 ? normal(random) : 0));
  }
  return touch_depth(tips, forces, depth(kThreshold) * kAlong, kThreshold);
}

TEST(SurfaceTouch, OfSpringsAndHertzContactsIsFoundExactly) {
  for (const double exponent : {2.0 / 3, 1.0}) {
    const std::optional<TouchDepth> found =
        depth_of([&](double force) { return 2.5 * std::pow(force, exponent); });
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->depth, 2.5 * std::pow(kThreshold, exponent), 1e-6) << exponent;
    EXPECT_LT(found->deviation, 1e-4);
    EXPECT_LT((found->along - kAlong).norm(), 1e-12);
  }
}

TEST(SurfaceTouch, OfClosedFormSpecimensIsNearerByFarThanTheThreshold) {
  const std::vector<std::shared_ptr<const Specimen>> specimens = {
      make_specimen(Sheet{}), make_specimen(Beam{}), make_specimen(ElasticBody{})};
  for (const auto& specimen : specimens) {
    const geometry::TriangleMesh& surface = specimen->surface();
    const Eigen::Vector3d place = surface.vertices.col(surface.vertices.cols() / 2);
    const Eigen::Vector3d axis = specimen->friction_cone(place).axis;
    const auto depth = [&](double force) {
      return specimen->displacement(place, force * axis).dot(axis);
    };
    const std::optional<TouchDepth> found = depth_of(depth);
    ASSERT_TRUE(found);
    const double truth = depth(kThreshold);
    EXPECT_LT(std::abs(found->depth - truth), 0.2 * truth) << found->depth;
    EXPECT_LT(std::abs(found->depth - truth), 3 * found->deviation + 1e-3) << found->deviation;
  }
}

TEST(SurfaceTouch, InNoiseStatesItsDeviation) {
  constexpr double kCompliance = 2;  // [mm/N]
  int within = 0;
  double squares = 0;
  constexpr int kRuns = 200;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const std::optional<TouchDepth> found =
        depth_of([](double force) { return kCompliance * force; }, 0.5, 0.01, seed);
    ASSERT_TRUE(found);
    const double error = found->depth - kCompliance * kThreshold;
    squares += error * error;
    within += std::abs(error) < 2 * found->deviation ? 1 : 0;
  }
  EXPECT_LT(std::sqrt(squares / kRuns), 0.3 * kCompliance * kThreshold);
  EXPECT_GE(within, 0.85 * kRuns);
}

TEST(SurfaceTouch, IsNotClaimedWithoutEnoughOfThePress) {
  const auto spring = [](double force) { return 2 * force; };
  EXPECT_FALSE(depth_of(spring, 0.15));                // hardly above the threshold
  EXPECT_FALSE(depth_of(spring, 0.5, 0, 1, 5));        // five moments
  EXPECT_FALSE(depth_of([](double) { return 1.0; }));  // no motion
}

}  // namespace
}  // namespace palpate::probing
