// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/force_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

TEST(ForceField, IsExactlyZeroAtZeroDisplacement) {
  EXPECT_EQ(force(some_field_with_ridge(), Eigen::Vector3d::Zero()), Eigen::Vector3d::Zero());
  EXPECT_EQ(potential(some_field_with_ridge(), Eigen::Vector3d::Zero()), 0);
}

TEST(ForceField, OneCentredBaseIsASofteningSpring) {
  const ForceField field = spring(2.5, 4);
  // f = w r / sqrt(r^2 + eps^2), p = w (sqrt(r^2 + eps^2) - eps)
  EXPECT_NEAR(force(field, {0, 3, 0}).y(), 2.5 * 3 / 5, 1e-15);
  EXPECT_NEAR(potential(field, {0, 3, 0}), 2.5 * (5 - 4), 1e-14);
  EXPECT_TRUE(stiffness(field, {0, 0, 0}).isApprox(2.5 / 4 * Eigen::Matrix3d::Identity(), 1e-15));
}

TEST(ForceField, ForceIsTheGradientOfThePotential) {
  // Central differences with step h: truncation h^2, rounding 1e-16 / h.
  constexpr double kStep = 1e-5;
  constexpr double kTolerance = 1e-8;
  const ForceField field = some_field_with_ridge();
  const Eigen::Matrix3Xd points = random_points(20, 6);
  for (const auto& x : points.colwise()) {
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d h = kStep * Eigen::Vector3d::Unit(axis);
      const double slope = (potential(field, x + h) - potential(field, x - h)) / (2 * kStep);
      EXPECT_NEAR(force(field, x)[axis], slope, kTolerance);
      const Eigen::Vector3d column = (force(field, x + h) - force(field, x - h)) / (2 * kStep);
      EXPECT_LT((stiffness(field, x).col(axis) - column).norm(), kTolerance);
    }
  }
}

TEST(ForceField, StiffnessAtZeroIsThePrintedMatrix) {
  ForceField field = some_field();
  Eigen::Matrix3d printed = Eigen::Matrix3d::Zero();
  for (Multiquadric& base : field.bases) {
    base.epsilon = 1;  // as printed in Eq 5.9
    const Eigen::Vector3d g = base.center;
    Eigen::Matrix3d m;
    m << g.y() * g.y() + g.z() * g.z() + 1, -g.x() * g.y(), -g.x() * g.z(),  //
        -g.x() * g.y(), g.x() * g.x() + g.z() * g.z() + 1, -g.y() * g.z(),   //
        -g.x() * g.z(), -g.y() * g.z(), g.x() * g.x() + g.y() * g.y() + 1;
    printed += base.weight / std::pow(g.squaredNorm() + 1, 1.5) * m;
  }
  EXPECT_TRUE(stiffness(field, Eigen::Vector3d::Zero()).isApprox(printed, 1e-14));
}

TEST(ForceField, ScalesWithTheUnitsExactly) {
  const ForceField field = some_field_with_ridge(), other = scaled(field, 0x1p-7, 0x1p10);
  const Eigen::Vector3d x(0.7, 1.3, -2.1);
  EXPECT_EQ(force(other, 0x1p10 * x), 0x1p-7 * force(field, x));
  EXPECT_EQ(potential(other, 0x1p10 * x), 0x1p3 * potential(field, x));
}

TEST(ForceField, StaysBoundedFarAway) {
  const Eigen::Vector3d far = force(some_field(), {1e9, -1e9, 1e9});
  EXPECT_LE(far.norm(), 2 * weight_sum(some_field()));
}

TEST(ForceField, ARidgePushesAlongItselfAlone) {
  const Eigen::Vector3d ridge = Eigen::Vector3d(1, -2, 2) / 3;
  const ForceField field{{{2.5, 4, Eigen::Vector3d::Zero(), ridge}}};
  const Eigen::Vector3d across = ridge.unitOrthogonal();
  EXPECT_TRUE(force(field, 3 * ridge + 7 * across).isApprox(2.5 * 3 / 5 * ridge, 1e-14));
  EXPECT_NEAR(potential(field, 3 * ridge + 7 * across), 2.5 * (5 - 4), 1e-14);
  // The place of its centre across the ridge does not matter.
  const ForceField moved{{{2.5, 4, 9 * across, ridge}}};
  EXPECT_TRUE(force(moved, 3 * ridge).isApprox(force(field, 3 * ridge), 1e-14));
}

TEST(ForceField, WithoutNegativeWeightsItIsConvexAndNowhereBelowZero) {
  ForceField field = some_field_with_ridge();
  for (Multiquadric& base : field.bases) base.weight = std::abs(base.weight);
  const Eigen::Matrix3Xd points = random_points(200, 30);
  for (const auto& x : points.colwise()) {
    EXPECT_GE(potential(field, x), 0);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(stiffness(field, x));
    EXPECT_GE(eigen.eigenvalues()[0], -1e-15);
  }
}

TEST(ForceField, TurnsWithItsFrame) {
  const ForceField field = some_field_with_ridge(), turned = rotated(field, some_rotation());
  const Eigen::Vector3d x(0.7, 1.3, -2.1);
  EXPECT_TRUE(force(turned, some_rotation() * x).isApprox(some_rotation() * force(field, x)));
}

TEST(ForceField, SmallDisplacementsKeepTheirEnergy) {
  const Eigen::Vector3d x(1e-9, -2e-9, 1e-9);
  const double quadratic = 0.5 * x.dot(stiffness(some_field(), Eigen::Vector3d::Zero()) * x);
  // Linear terms of about 1e-9 cancel to 1e-18: what is left has a relative error of about 1e-7.
  EXPECT_NEAR(potential(some_field(), x) / quadratic, 1, 1e-5);
}

TEST(ForceField, RefusesWhatIsNoField) {
  ForceField field = some_field();
  EXPECT_NO_THROW(check_force_field(field, "f"));
  field.bases[1].epsilon = 0;
  EXPECT_THAT(refusal([&] {
                check_force_field(field, "f");
                return 0;
              }),
              ::testing::HasSubstr("epsilon"));
  field = some_field();
  field.bases[2].center.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal([&] {
                check_force_field(field, "f");
                return 0;
              }),
              ::testing::HasSubstr("base 2"));
  field = some_field();
  field.bases[0].ridge = {0, 1, 1e-3};
  EXPECT_THAT(refusal([&] {
                check_force_field(field, "f");
                return 0;
              }),
              ::testing::HasSubstr("ridge"));
}

}  // namespace
}  // namespace palpate::haptics
