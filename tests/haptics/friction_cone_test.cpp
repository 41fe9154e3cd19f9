// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/friction_cone.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

const Eigen::Vector3d kAxis = Eigen::Vector3d(0.2, -0.1, 0.9).normalized();

// Vectors on a cone about kAxis, at `count` directions over `range` and three heights.
Eigen::Matrix3Xd cone_vectors(double slope, int count, double range = 2 * std::numbers::pi) {
  const Eigen::Vector3d u = kAxis.unitOrthogonal(), v = kAxis.cross(u);
  Eigen::Matrix3Xd vectors(3, 3 * count);
  for (int i = 0; i < vectors.cols(); ++i) {
    const double angle = range * (i / 3) / count, height = 0.3 + (i % 3);
    vectors.col(i) = height * (kAxis + slope * (std::cos(angle) * u + std::sin(angle) * v));
  }
  return vectors;
}

TEST(FitCone, RecoversAxisAndSlope) {
  for (const double slope : {0.05, 0.91, 3.0}) {
    const ConeFit fit = fit_cone(cone_vectors(slope, 8));
    EXPECT_EQ(fit.stop, ConeStop::converged);
    EXPECT_NEAR(fit.cone.slope, slope, 1e-9 * (1 + slope * slope));
    EXPECT_LT((fit.cone.axis - kAxis).norm(), 1e-9);
    EXPECT_LT(fit.cone.rms, 1e-9);
    EXPECT_EQ(fit.cone.samples, 24);
  }
}

TEST(FitCone, FindsTheAxisFromUnevenDirections) {
  const ConeFit fit = fit_cone(cone_vectors(0.7, 12, 4.5));  // three quarters of a turn
  EXPECT_EQ(fit.stop, ConeStop::converged);
  EXPECT_NEAR(fit.cone.slope, 0.7, 1e-8);
  EXPECT_LT((fit.cone.axis - kAxis).norm(), 1e-8);
}

TEST(FitCone, StaysWithTheMajorityAgainstOutliers) {
  Eigen::Matrix3Xd vectors = cone_vectors(0.91, 16) + random_points(48, 0.01);
  vectors.col(5) += Eigen::Vector3d(1, 1, 0);
  vectors.col(20) *= -0.2;
  const ConeFit fit = fit_cone(vectors);
  EXPECT_EQ(fit.stop, ConeStop::converged);
  // Errors of 0.005 over 48 vectors of size 1, and what Huber's loss leaves of the outliers.
  EXPECT_NEAR(fit.cone.slope, 0.91, 0.01);
  EXPECT_LT((fit.cone.axis - kAxis).norm(), 0.01);
}

TEST(FitCone, TurnsWithTheVectorsAndDoesNotScale) {
  const Eigen::Matrix3Xd vectors = cone_vectors(0.91, 8) + random_points(24, 0.05);
  const ConeFit fit = fit_cone(vectors), turned = fit_cone(0x1p-30 * some_rotation() * vectors);
  EXPECT_LT((turned.cone.axis - some_rotation() * fit.cone.axis).norm(), 1e-8);
  EXPECT_NEAR(turned.cone.slope, fit.cone.slope, 1e-8);
  EXPECT_NEAR(turned.cone.rms, 0x1p-30 * fit.cone.rms, 1e-8 * 0x1p-30);
}

TEST(FitCone, SaysWhenTheVectorsDoNotDetermineACone) {
  EXPECT_EQ(fit_cone(Eigen::Matrix3Xd(3, 0)).stop, ConeStop::not_determined);
  EXPECT_EQ(fit_cone(cone_vectors(0.9, 8).leftCols(4)).stop, ConeStop::not_determined);
  EXPECT_EQ(fit_cone(Eigen::Vector3d(1, 2, 3).replicate(1, 20)).stop, ConeStop::not_determined);
  EXPECT_EQ(fit_cone(cone_vectors(0.9, 8, 0.3)).stop, ConeStop::not_determined);
  EXPECT_EQ(fit_cone(Eigen::Matrix3Xd::Zero(3, 9)).stop, ConeStop::not_determined);
  Eigen::Matrix3Xd vectors = cone_vectors(0.9, 8);
  vectors(2, 6) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal([&] { return fit_cone(vectors); }), testing::HasSubstr("vector 6"));
}

const probing::Contact kContact{1, {0, 0, 700}, {0, 0, -1}};

probing::Sample sample(long long group, const Eigen::Vector3d& force, bool held) {
  return {.id = 0,
          .contact = 1,
          .group = group,
          .force = force,
          .a = {0, 0, 0},
          .b = kContact.position + 2 * force,
          .on_friction_boundary = held,
          .slipped = !held};
}

TEST(BoundaryForces, LieBetweenWhatHeldAndTheLeastThatSlippedInTheSameDirection) {
  std::vector<probing::Sample> samples = {
      sample(1, {1, 0, 2}, true),    sample(1, {1.5, 0, 2}, false), sample(1, {1.25, 0, 2}, false),
      sample(1, {0, 1.1, 2}, false), sample(2, {1.1, 0, 2}, false), sample(1, {-1.1, 0, 2}, false),
      sample(2, {0, 3, 4}, true)};
  samples.push_back(samples[0]);
  samples.back().contact = 9;
  const Eigen::Matrix3Xd forces = boundary_forces(kContact, samples);
  ASSERT_EQ(forces.cols(), 2);
  EXPECT_EQ(forces.col(0), Eigen::Vector3d(1.125, 0, 2));
  EXPECT_EQ(forces.col(1), Eigen::Vector3d(0, 3, 4));
}

TEST(FrictionAxis, IsTheMeanDirectionOfTheBoundary) {
  const std::vector<probing::Sample> samples = {
      sample(1, {1, 0, 2}, true), sample(1, {-1, 0, 2}, true), sample(1, {5, 5, 2}, false)};
  EXPECT_EQ(friction_axis(kContact, samples).value(), Eigen::Vector3d(0, 0, 1));
  EXPECT_FALSE(friction_axis(kContact, std::span(samples).last(1)).has_value());
}

}  // namespace
}  // namespace palpate::haptics
