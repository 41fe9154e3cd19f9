// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/rounding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "haptics_testing.h"
#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

TEST(Rounding, FindsTheNearestShortNumber) {
  EXPECT_EQ(round_to_digits(1234.56789, 7), 1234.568);
  EXPECT_EQ(round_to_digits(-0.000123456749, 7), -0.0001234567);
  EXPECT_EQ(round_to_digits(9.99999999, 3), 10.0);
  EXPECT_EQ(round_to_digits(6.02214076e23, 4), 6.022e23);
  EXPECT_EQ(round_to_digits(2.5e-320, 1), 2e-320);
  EXPECT_EQ(round_to_places(0.123456789, 7), 0.1234568);
  EXPECT_EQ(round_to_places(-123456789.123, 1), -123456789.1);
  EXPECT_FALSE(std::signbit(round_to_places(-1e-9, 7)));
}

TEST(Rounding, LeavesWhatHasNoDigits) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kMax = std::numeric_limits<double>::max();
  EXPECT_EQ(round_to_digits(-kInfinity, 7), -kInfinity);
  EXPECT_TRUE(std::isnan(round_to_digits(std::nan(""), 7)));
  EXPECT_TRUE(std::isnan(round_to_places(std::nan(""), 7)));
  EXPECT_EQ(round_to_digits(0, 7), 0);
  EXPECT_EQ(round_to_digits(kMax, 1), kMax);  // 2e308 is no number
  EXPECT_EQ(round_to_places(kMax, 7), kMax);
}

TEST(Rounding, KeepsForcesFarBelowWhatCanBeMeasured) {
  const ForceField field = scaled(some_field_with_ridge(), 10.1, 1.7);
  const ForceField shortened = rounded(field);
  EXPECT_NE(shortened, field);
  const Eigen::Matrix3Xd displacements = random_points(200, 20);
  const Eigen::Matrix3Xd errors =
      forces_at(shortened, displacements) - forces_at(field, displacements);
  // Each base may be off by some half units of the last digit of its weight, and as much by its
  // lengths.
  EXPECT_LE(errors.colwise().norm().maxCoeff(), 10 * 0.5e-6 * weight_sum(field));
  EXPECT_GT(errors.norm(), 0);
}

TEST(Rounding, MovesTheCentreOfARidgeWithinItsPlaneOnly) {
  const Multiquadric base{1.5, 2, {3.1, -4.2, 0.7}, {0.48, -0.6, 0.64}};
  const Multiquadric moved = rounded(ForceField{{base}}).bases[0];
  EXPECT_NEAR((moved.ridge - base.ridge).norm(), 0, 1e-6);
  EXPECT_NEAR(moved.ridge.norm(), 1, 1e-15);
  EXPECT_NEAR(moved.ridge.cross(moved.center).norm(), 0, 1e-14);
  EXPECT_NEAR(moved.ridge.dot(moved.center), base.ridge.dot(base.center), 2e-6);
}

TEST(Rounding, PutsIsotropicBasesFirst) {
  const ForceField field = some_field_with_ridge();
  ForceField turned = field;
  std::rotate(turned.bases.begin(), turned.bases.end() - 1, turned.bases.end());
  EXPECT_NE(turned, field);
  EXPECT_EQ(rounded(turned), rounded(field));
}

TEST(Rounding, ChangesNothingTheSecondTime) {
  for (int i = 0; i < 300; ++i) {
    const Eigen::Matrix3Xd points = random_points(4, 30, static_cast<unsigned>(i));
    const ForceField field = {
        {{points(0, 0), 1 + std::abs(points(1, 0)), points.col(1), Eigen::Vector3d::Zero()},
         {points(2, 0), 0.3, points.col(2), points.col(3).normalized()},
         {1, 1, points.col(2), {std::sqrt(0.5), -std::sqrt(0.5), 0}}}};
    const ForceField once = rounded(field);
    EXPECT_EQ(rounded(once), once);
    EXPECT_NO_THROW(check_force_field(once, "rounded"));
  }
}

// The largest entry of the slope is rounded up to where one decimal place less is stored.
TEST(Rounding, ChangesNothingTheSecondTimeWherePlacesChange) {
  const Eigen::Vector3d along = Eigen::Vector3d(0.9, 0.123456789, -0.35).normalized();
  for (const double largest : {2.99999996, 29.9999996, 0.299999996, 0.0299999996}) {
    const ForceField field = {{{1.5, along.x() / largest, {0.4, 0.2, 0.1}, along}}};
    const ForceField once = rounded(field);
    EXPECT_EQ(rounded(once), once) << largest;
  }
}

TEST(Rounding, KeepsFramesAndAxesExactlyWhatTheyAre) {
  for (int i = 0; i < 300; ++i) {
    const Eigen::Matrix3Xd points = random_points(2, 3, static_cast<unsigned>(i));
    ContactModel contact;
    // Half turns and quarter turns about the axes have quaternions with entries that are alike.
    contact.frame =
        i < 27 ? rotation_exp(std::numbers::pi / 2 * Eigen::Vector3d(i % 3, i / 3 % 3, i / 9))
               : rotation_exp(points.col(0));
    contact.friction_axis = points.col(1).normalized();
    contact.field = some_field_with_ridge();
    const ContactModel once = rounded(contact);
    constexpr double kExactly = 1e-15;
    EXPECT_TRUE(is_rotation(once.frame, kExactly));
    EXPECT_NEAR(once.friction_axis.norm(), 1, kExactly);
    EXPECT_EQ(once.field, rounded(contact.field));
    const ContactModel twice = rounded(once);
    EXPECT_EQ(twice.frame, once.frame);
    EXPECT_EQ(twice.friction_axis, once.friction_axis);
    // Half a unit of the seventh decimal of a quaternion, or an axis, whose largest entry is 1.
    EXPECT_LE((once.frame - contact.frame).norm(), 4e-7);
    EXPECT_LE((once.friction_axis - contact.friction_axis).norm(), 1e-7);
  }
}

TEST(Rounding, KeepsPositionsToTheNinthDigitOfTheObjectHoweverFarItIs) {
  const Eigen::Vector3d at = Eigen::Vector3d(1, 2, 3) * std::numbers::pi;
  for (const double size : {0.02, 1.0, 170.0, 999.0}) {
    for (const double far : {0.0, 1e3, 0x1p30}) {
      const Eigen::Vector3d position = size * at + Eigen::Vector3d(far, -far, 2 * far);
      const Eigen::Vector3d once = rounded_position(position, size);
      // Half a unit of the ninth digit, and of doubles there.
      EXPECT_LE((once - position).cwiseAbs().maxCoeff(), 0.5e-8 * size + 2e-16 * far);
      EXPECT_EQ(rounded_position(once, size), once);
    }
  }
  EXPECT_EQ(rounded_position({123.4567891234, -0.00000012, 1e9}, 170),
            Eigen::Vector3d(123.456789, 0, 1e9));
}

TEST(Rounding, KeepsSigns) {
  const ForceField field = rounded(ForceField{{{1e-300, 1e-200}, {0, 1}, {-1e-9, 2}}});
  EXPECT_GT(field.bases[0].weight, 0);
  EXPECT_GT(field.bases[0].epsilon, 0);
  EXPECT_EQ(field.bases[1].weight, 0);
  EXPECT_LT(field.bases[2].weight, 0);
}

}  // namespace
}  // namespace palpate::haptics
