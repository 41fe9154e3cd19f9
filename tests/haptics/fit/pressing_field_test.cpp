// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/pressing_field.h"

#include <gtest/gtest.h>

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

PressingCurve curve_of(const Eigen::VectorXd& coefficients) {
  return {.coefficients = coefficients, .reach = 4};
}

TEST(PressingField, FollowsHardeningAndSofteningCurves) {
  for (const double square : {0.0, 0.05, 0.2, -0.03}) {
    const PressingCurve curve = curve_of(Eigen::Vector2d(0.3, square));
    const ForceField field = pressing_field(curve, 0.7, kMaxConvexBases);
    const double largest = force_at(curve, 4);
    for (double depth = 0.1; depth <= 4; depth += 0.1) {
      const Vector3d found = force(field, {0, 0, depth});
      EXPECT_NEAR(found.z(), force_at(curve, depth), 0.01 * largest) << square << ' ' << depth;
      EXPECT_EQ(found.head<2>(), Eigen::Vector2d(0, 0));
    }
    for (const Multiquadric& base : field.bases) EXPECT_GT(base.weight, 0);  // convex
  }
}

TEST(PressingField, HasTheGivenShareOfTheStiffnessAcross) {
  const PressingCurve curve = curve_of(Eigen::Vector2d(0.3, 0.05));
  const ForceField field = pressing_field(curve, 0.7, kMaxConvexBases);
  const double across = 0.7 * force_at(curve, 2.8) / 2.8;
  for (const Vector3d& along : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0.6, 0.8, 0)})
    EXPECT_NEAR(along.dot(stiffness(field, {0, 0, 2}) * along), across, 0.02 * across);
}

TEST(PressingField, StaysLevelWhereTheCurveFalls) {
  const ForceField field =
      pressing_field(curve_of(Eigen::Vector2d(0.4, -0.08)), 0.7, kMaxConvexBases);
  const double top = 0.5;  // at 2.5 mm
  for (double depth = 2.5; depth <= 4; depth += 0.5)
    EXPECT_NEAR(force(field, {0, 0, depth}).z(), top, 0.05 * top);
}

TEST(PressingField, TakesNoMoreBasesThanItMay) {
  const PressingCurve curve = curve_of(Eigen::Vector3d(0.1, -0.04, 0.04));
  const double largest = force_at(curve, 4);
  ASSERT_GT(pressing_field(curve, 0.7, kMaxConvexBases).bases.size(), 4u);
  for (const int most : {3, 4}) {
    const ForceField field = pressing_field(curve, 0.7, most);
    EXPECT_EQ(field.bases.size(), static_cast<std::size_t>(most));
    for (double depth = 0.5; depth <= 4; depth += 0.5)
      EXPECT_NEAR(force(field, {0, 0, depth}).z(), force_at(curve, depth), 0.1 * largest) << most;
  }
}

TEST(PressingField, IsZeroWithoutForceOrReach) {
  EXPECT_TRUE(
      pressing_field(curve_of(Eigen::Vector2d(-0.1, 0)), 0.7, kMaxConvexBases).bases.empty());
  PressingCurve curve = curve_of(Eigen::Vector2d(0.3, 0));
  curve.reach = 0;
  EXPECT_TRUE(pressing_field(curve, 0.7, kMaxConvexBases).bases.empty());
}

}  // namespace
}  // namespace palpate::haptics
