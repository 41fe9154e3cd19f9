// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/packed_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "height_field_model.h"
#include "sheet_model.h"
#include "sphere_model.h"

namespace palpate::haptics {
namespace {

// Relative, of forces above 1 N: some hundred operations, and inverses of 2 x 2 matrices.
constexpr double kPackedTolerance = 1e-12;

// The largest differences from `BlendedField` at random places and displacements.
void expect_equal_to_blended(const Model& model, int count) {
  const PackedField packed(model);
  const BlendedField& blended = packed.blended();
  const Eigen::Matrix3Xd places = random_points(count, 45), pushes = random_points(count, 12, 2);
  PlaceField at;
  for (int i = 0; i < count; ++i) {
    const geometry::ClosestPoint place = blended.surface().closest_point(places.col(i));
    const Blend expected = blended.blend(place.at);
    packed.move_to(place.at, place.position, at);
    const Eigen::Vector3d force = blended.force(expected, pushes.col(i));
    EXPECT_LT((packed.force(at, pushes.col(i)).force - force).norm(),
              kPackedTolerance * std::max(1.0, force.norm()))
        << i << ' ' << force.norm();
    EXPECT_NEAR(at.friction, expected.friction, kPackedTolerance);
    EXPECT_LT((at.cone_axis - expected.frame.col(2)).norm(), kPackedTolerance);
    EXPECT_LT((at.friction_axis.normalized() - expected.friction_axis).norm(), kPackedTolerance);
    EXPECT_NEAR(friction_parts(at, force).excess, friction_parts(expected, force).excess,
                kPackedTolerance);
  }
}

TEST(PackedField, EqualsTheBlendedFieldWithCompliances) {
  expect_equal_to_blended(height_field_model({.height = waves, .uneven = true}), 2000);
}

TEST(PackedField, BlendsHowFrictionDependsOnTheLoad) {
  Model model = height_field_model({.height = waves, .uneven = true});
  model.friction_force = 1.3;
  for (std::size_t i = 0; i < model.contacts.size(); ++i)
    model.contacts[i].load_exponent = i % 2 == 0 ? -0.2 : 0.05;
  expect_equal_to_blended(model, 500);

  const PackedField field(model);
  PlaceField at;
  const auto place = field.blended().surface().closest_point(model.contacts[24].position);
  field.move_to(place.at, place.position, at);
  const ContactModel& contact = model.contacts[24];
  const double normal = 2.6, limit = contact.friction * normal * std::pow(2.0, -0.2);
  const Eigen::Vector3d force = normal * at.cone_axis + limit * at.cone_axis.unitOrthogonal();
  EXPECT_NEAR(friction_parts(at, force).excess, 0, 1e-9);
}

TEST(PackedField, EqualsTheBlendedFieldAllRoundABall) {
  expect_equal_to_blended(
      with_compliances(ball_model([](const Eigen::Vector3d&) { return true; }, uneven_twist), 2),
      1000);
}

TEST(PackedField, EqualsTheBlendedFieldWhereContactsHaveNoCompliance) {
  Model model = height_field_model({.height = waves, .uneven = true});
  for (std::size_t i = 0; i < model.contacts.size(); i += 3) model.contacts[i].compliance.reset();
  expect_equal_to_blended(model, 500);
  model.interpolation = {};
  expect_equal_to_blended(model, 500);
}

TEST(PackedField, TakesAnyNumberOfBasesAndRidgesOfRoundedLength) {
  Model model = uneven_model();
  for (int i = 0; i < 30; ++i) {
    Multiquadric base{.weight = 0.1, .epsilon = 2.0 + i, .center = {0.1 * i, 1, -1}};
    if (i % 2) base.ridge = some_rotation().col(i % 3) * (1 + 1e-7);
    for (ContactModel& contact : model.contacts) contact.field.bases.push_back(base);
  }
  model.contacts[1].field.bases.clear();
  expect_equal_to_blended(model, 200);
}

TEST(PackedField, ForceIsTheGradientOfTheEnergyAndBothAreZeroAtZero) {
  const Model model = height_field_model({.height = waves, .uneven = true});
  const PackedField field(model);
  const Eigen::Matrix3Xd places = random_points(100, 28), pushes = random_points(100, 6, 2);
  PlaceField at;
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    const auto place = field.blended().surface().closest_point(places.col(i));
    field.move_to(place.at, place.position, at);
    const FieldForce zero = field.force(at, Eigen::Vector3d::Zero());
    EXPECT_EQ(zero.force, Eigen::Vector3d::Zero());
    EXPECT_EQ(zero.energy, 0);
    Eigen::Vector3d gradient;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = kDifferenceStep * Eigen::Vector3d::Unit(k);
      gradient[k] = (field.force(at, pushes.col(i) + step).energy -
                     field.force(at, pushes.col(i) - step).energy) /
                    (2 * kDifferenceStep);
    }
    EXPECT_LT((gradient - field.force(at, pushes.col(i)).force).norm(), kDifferenceTolerance);
  }
}

TEST(PackedField, DoesNotDependOnThePlaceBefore) {
  const Model model = height_field_model({.height = waves, .uneven = true});
  const PackedField field(model), other(model);
  PlaceField used;
  for (const Eigen::Vector3d& place : {Eigen::Vector3d(3, 4, 0), {-20, 7, 0}, {3.1, 4, 0}}) {
    const auto at = field.blended().surface().closest_point(place);
    PlaceField fresh;
    other.move_to(at.at, at.position, used);  // of another field
    field.move_to(at.at, at.position, used);
    field.move_to(at.at, at.position, fresh);
    EXPECT_EQ(field.force(used, kDisplacement).force, field.force(fresh, kDisplacement).force);
  }
}

TEST(PackedField, GivesNoForceForWhatIsNotFinite) {
  const PackedField field(uneven_model());
  PlaceField at;
  EXPECT_EQ(field.force(at, kDisplacement).force, Eigen::Vector3d::Zero());  // of no place
  field.move_to({.triangle = 3, .barycentric = {0.2, 0.3, 0.5}}, {0, 0, 700}, at);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(field.force(at, {nan, 0, 0}).force, Eigen::Vector3d::Zero());
  field.move_to({.triangle = -1}, {nan, 0, 0}, at);
  EXPECT_EQ(at.count, 0);
  EXPECT_EQ(field.force(at, kDisplacement).force, Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace palpate::haptics
