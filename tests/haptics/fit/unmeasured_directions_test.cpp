// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/unmeasured_directions.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "palpate/haptics/force_field_fit.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

constexpr double kNoise = 0.02, kJitter = 0.005;  // [N], [mm]
const Vector3d kStiffness(0.9, 0.6, 1.5);         // [N/mm]

struct Pairs {
  Eigen::Matrix3Xd displacements, forces;
};

// Forces of a spring at displacements in a box of the given half sizes [mm], with noise, in a frame
// that is turned.
Pairs pairs_in(const Vector3d& box, const Eigen::Matrix3d& turn, double bias = 0) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(-1, 1);
  std::normal_distribution<double> normal;
  Pairs pairs;
  pairs.displacements.resize(3, 60);
  pairs.forces.resize(3, 60);
  for (int i = 0; i < 60; ++i) {
    const Vector3d x = box.cwiseProduct(Vector3d{share(random), share(random), share(random)});
    const Vector3d noise{normal(random), normal(random), normal(random)};
    pairs.displacements.col(i) = turn * x;
    pairs.forces.col(i) =
        turn * (kStiffness.cwiseProduct(x) + kNoise * noise + bias * Vector3d(1, 1, 0));
  }
  return pairs;
}

const Eigen::Matrix3d kTurn =
    Eigen::Quaterniond(0.3, -0.5, 0.7, 0.4).normalized().toRotationMatrix();

TEST(UnmeasuredDirections, AreThoseWithoutDisplacementsBeyondNoise) {
  const auto count = [](const Vector3d& box) {
    const Pairs pairs = pairs_in(box, kTurn);
    return unmeasured_directions(pairs.displacements, pairs.forces, kDisplacementNoise, kNoise)
        .count;
  };
  EXPECT_EQ(count({2, 2, 3}), 0);
  EXPECT_EQ(count({kJitter, 2, 3}), 1);
  EXPECT_EQ(count({kJitter, kJitter, 3}), 2);
}

TEST(UnmeasuredDirections, AreNotThoseInWhichAnObjectIsRigid) {
  // Forces of 1 N along x, independent of all others, move the tool by no more than noise.
  Pairs pairs = pairs_in({0, 2, 3}, kTurn);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> force(-1, 1);
  for (auto f : pairs.forces.colwise()) f += force(random) * kTurn.col(0);
  EXPECT_EQ(
      unmeasured_directions(pairs.displacements, pairs.forces, kDisplacementNoise, kNoise).count,
      0);
}

double along(const FitResult& fit, const Vector3d& axis) {
  return axis.dot(stiffness(fit.field, Vector3d(0, 0, 0)) * axis);
}

TEST(FitForceField, MakesNoStiffnessOfNoise) {
  // A tenth of a newton across, which noise of 5 um would turn into 20 N/mm.
  for (const Vector3d& box : {Vector3d(kJitter, 2, 3), Vector3d(kJitter, kJitter, 3),
                              Vector3d(0, 0, 3), Vector3d(0, 2, 3)}) {
    const Pairs pairs = pairs_in(box, kTurn, 0.1);
    const FitResult fit = fit_force_field(pairs.displacements, pairs.forces,
                                          {.try_certified = false, .noise = {.force = kNoise}});
    EXPECT_EQ(fit.unmeasured, box.y() > 1 ? 1 : 2) << box.transpose();
    // The half-space's, relative to what was measured; the true ones are 0.6 and 0.4.
    EXPECT_GT(along(fit, kTurn.col(0)), 0.4) << box.transpose();
    EXPECT_LT(along(fit, kTurn.col(0)), 2) << box.transpose();
    EXPECT_NEAR(along(fit, kTurn.col(2)), kStiffness.z(), 0.15) << box.transpose();
    for (const auto& x : pairs.displacements.colwise())
      EXPECT_LT(
          (force(fit.field, x) - kTurn * kStiffness.asDiagonal() * kTurn.transpose() * x).norm(),
          0.3);
  }
}

TEST(FitForceField, TakesTheExpectedStiffnessWhereNoneIsMeasured) {
  const Pairs pairs = pairs_in({kJitter, kJitter, 3}, kTurn);
  FitOptions options{.try_certified = false, .noise = {.force = kNoise}};
  options.expected_stiffness = Eigen::Matrix3d(kTurn * kStiffness.asDiagonal() * kTurn.transpose());
  const FitResult fit = fit_force_field(pairs.displacements, pairs.forces, options);
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(along(fit, kTurn.col(k)), kStiffness(k), 0.1 * kStiffness(k)) << k;
}

TEST(FitForceField, FollowsForcesAcrossAPressAtAnAngle) {
  // Along a line at 30 degrees to the stiff direction, the force does not lie along the line.
  const Vector3d line(0.5, 0, std::sqrt(0.75));
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, kNoise);
  Pairs pairs;
  pairs.displacements.resize(3, 20);
  pairs.forces.resize(3, 20);
  for (int i = 0; i < 20; ++i) {
    const Vector3d x = 0.15 * (i + 1) * line;
    pairs.displacements.col(i) = x;
    pairs.forces.col(i) =
        kStiffness.cwiseProduct(x) + Vector3d{noise(random), noise(random), noise(random)};
  }
  const FitResult fit = fit_force_field(pairs.displacements, pairs.forces,
                                        {.try_certified = false, .noise = {.force = kNoise}});
  EXPECT_EQ(fit.unmeasured, 2);
  EXPECT_LT(fit.rms, 3 * kNoise);
}

}  // namespace
}  // namespace palpate::haptics
