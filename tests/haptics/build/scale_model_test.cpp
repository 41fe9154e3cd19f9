// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/scale_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "model_testing.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/contact_compliance.h"
#include "palpate/haptics/contact_strength.h"
#include "palpate/haptics/rounding.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

// Of the entries of axes, in numbers of `kFieldDigits` digits.
constexpr double kStored = 1e-6;

Vector3d contact_force(const Model& model, std::size_t i, const Vector3d& displacement) {
  const ContactModel& contact = model.contacts[i];
  return contact.frame * force(contact.field, contact.frame.transpose() * displacement);
}

// Fields of ridges, tilted frames.
Model ridge_model() {
  Model model = uneven_model();
  for (ContactModel& contact : model.contacts) {
    contact.field.bases = {
        {.weight = 2, .epsilon = 3, .ridge = Vector3d(0.2, 0.1, 1).normalized()},
        {.weight = 1,
         .epsilon = 4,
         .center = {1, 2, 3},
         .ridge = Vector3d(1, -0.3, 0.2).normalized()},
        {.weight = 1.5, .epsilon = 5, .ridge = Vector3d(0.1, 1, -0.2).normalized()}};
  }
  return model;
}

TEST(ScaleModel, MultipliesStiffnessByTheLengthForTheSameMaterial) {
  const Model model = uneven_model();
  const ScaledModel large = scale_model(model, {.factor = 2.5});
  EXPECT_NO_THROW(check_model(large.model));
  EXPECT_EQ(large.refitted, 0);
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3d expected = 2.5 * 2.5 * contact_force(model, i, kDisplacement);
    EXPECT_LT((contact_force(large.model, i, 2.5 * kDisplacement) - expected).norm(),
              kForceRounding);
    EXPECT_LT((stiffness(large.model.contacts[i].field, Vector3d::Zero()) -
               2.5 * stiffness(model.contacts[i].field, Vector3d::Zero()))
                  .norm(),
              kForceRounding);
    EXPECT_NEAR(large.model.contacts[i].friction, model.contacts[i].friction, 1e-9);
    EXPECT_NEAR(large.model.contacts[i].rms, 2.5 * 2.5 * model.contacts[i].rms, 1e-6);
  }
  // About the middle, which is (0, 0, 700).
  EXPECT_LT((large.model.contacts[0].position - Vector3d(-75, -75, 700)).norm(), 1e-12);
  EXPECT_NEAR(large.model.surface.vertices.row(0).maxCoeff(), 125, 1e-12);
  EXPECT_EQ(large.model.made.at("scaled"), "by 2.5, material");
}

TEST(ScaleModel, KeepsTheTriangulationAndNothingOfTheAcquisition) {
  const Model scaled = scale_model(some_model(), {.factor = 2.5}).model;
  EXPECT_EQ(scaled.triangulation, geometry::ContactTriangulationMethod::voronoi_dual);
  EXPECT_FALSE(scaled.samples_fingerprint || scaled.pressing_offsets || scaled.noise);
  EXPECT_TRUE(scaled.T_surface_acquisition.matrix().isIdentity(0));
}

// A ball that scales with the object presses alike; a stretched one is no ball.
TEST(ScaleModel, ScalesTheBallThatProbedWithTheObject) {
  Model model = uneven_model();
  EXPECT_FALSE(scale_model(model, {.factor = 3}).model.probe_radius);
  model.probe_radius = 2;
  const auto radius = [&](const ScaleModelOptions& options) {
    return scale_model(model, options).model.probe_radius;
  };
  EXPECT_EQ(radius({.factor = 3}), 6);
  EXPECT_EQ(radius({.factor = 3, .forces = ForceScaling::forces}), 6);
  EXPECT_EQ(radius({.factor = 3, .forces = ForceScaling::feel}), 2);
  EXPECT_FALSE(radius({.factor = 3, .axis = Vector3d::UnitX()}));
}

TEST(ScaleModel, RefitsNothingUniformlyInRoundedFrames) {
  Model model = moved(uneven_model(), some_motion());
  for (ContactModel& contact : model.contacts) contact = rounded(std::move(contact));
  EXPECT_EQ(scale_model(model, {.factor = 1.5}).refitted, 0);
}

// The limit of the tangential force grows with the forces of the object, and its ratio to the
// normal force stays.
TEST(ScaleModel, ScalesTheForceThatFrictionDependsOn) {
  Model model = uneven_model();
  model.friction_force = 1.5;
  for (ContactModel& contact : model.contacts) contact.load_exponent = -0.1;
  const Model large = scale_model(model, {.factor = 2}).model;
  EXPECT_NEAR(large.friction_force, 4 * 1.5, 1e-12);
  for (std::size_t i = 0; i < 4; ++i) {
    const ContactModel &a = model.contacts[i], &b = large.contacts[i];
    EXPECT_NEAR(friction_limit(b.friction, b.load_exponent, large.friction_force, 4 * 2.2),
                4 * friction_limit(a.friction, a.load_exponent, model.friction_force, 2.2), 1e-6);
  }
  EXPECT_EQ(scale_model(model, {.factor = 2, .forces = ForceScaling::feel}).model.friction_force,
            1.5);
}

TEST(ScaleModel, KeepsForcesOrTheFeelOnRequest) {
  const Model model = uneven_model();
  const Model same_forces = scale_model(model, {.factor = 3, .forces = ForceScaling::forces}).model;
  const Model same_feel = scale_model(model, {.factor = 3, .forces = ForceScaling::feel}).model;
  const BlendedField before(model), forces(same_forces), feel(same_feel);
  const Vector3d place(5, 10, 700), there(15, 30, 700);  // between contacts
  const Vector3d expected = before.force(place, kDisplacement);
  EXPECT_LT((forces.force(there, 3 * kDisplacement) - expected).norm(), kForceRounding);
  EXPECT_LT((feel.force(there, kDisplacement) - expected).norm(), kForceRounding);
}

TEST(ScaleModel, StretchesABarAsItsMaterialWould) {
  const Model model = ridge_model();
  const ScaledModel longer =
      scale_model(model, {.factor = 1.8, .axis = Vector3d(0.5, 0, 0)});  // any length
  EXPECT_EQ(longer.refitted, 0);
  EXPECT_NO_THROW(check_model(longer.model));
  const Vector3d stretch(1.8, 1, 1);
  for (std::size_t i = 0; i < 4; ++i) {
    // The same strain: the force along the bar stays, that across goes with its length.
    const Vector3d expected =
        contact_force(model, i, kDisplacement).cwiseProduct(Vector3d(1, 1.8, 1.8));
    const Vector3d displacement = kDisplacement.cwiseProduct(stretch);
    EXPECT_LT((contact_force(longer.model, i, displacement) - expected).norm(), kForceRounding);
    const ContactModel &now = longer.model.contacts[i], &then = model.contacts[i];
    EXPECT_LT((now.position - Vector3d(1.8 * then.position.x(), then.position.y(), 700)).norm(),
              1e-12);
    // z is a normal, the axis of friction a displacement.
    EXPECT_LT((now.frame.col(2) - then.frame.col(2).cwiseQuotient(stretch).normalized()).norm(),
              kStored);
    EXPECT_LT((now.friction_axis - then.friction_axis.cwiseProduct(stretch).normalized()).norm(),
              kStored);
  }
}

TEST(ScaleModel, ScalesBack) {
  const Model model = ridge_model();
  for (const auto& axis :
       {std::optional<Vector3d>(), std::optional<Vector3d>(Vector3d(1, 2, 0.5))}) {
    const Model there = scale_model(model, {.factor = 1.7, .axis = axis}).model;
    const Model back = scale_model(there, {.factor = 1 / 1.7, .axis = axis}).model;
    EXPECT_LT((back.surface.vertices - model.surface.vertices).norm(), 1e-9);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_LT(
          (contact_force(back, i, kDisplacement) - contact_force(model, i, kDisplacement)).norm(),
          kForceRounding);
      EXPECT_LT((back.contacts[i].position - model.contacts[i].position).norm(), 1e-9);
      EXPECT_LT((back.contacts[i].frame.col(2) - model.contacts[i].frame.col(2)).norm(), kStored);
    }
  }
}

TEST(ScaleModel, SaysWhatIsNotExactAlongAnAxis) {
  Model model = sheet_model();  // isotropic bases
  const ScaledModel longer = scale_model(model, {.factor = 1.5, .axis = Vector3d::UnitX()});
  EXPECT_EQ(longer.refitted, 4);
  EXPECT_GT(longer.refit_rms, 0);
  EXPECT_LT(longer.refit_rms, 0.05);  // [N] of forces of up to 4 N
  const Vector3d expected =
      contact_force(model, 1, kDisplacement).cwiseProduct(Vector3d(1, 1.5, 1.5));
  EXPECT_LT(
      (contact_force(longer.model, 1, kDisplacement.cwiseProduct(Vector3d(1.5, 1, 1))) - expected)
          .norm(),
      0.1);
}

TEST(ScaleModel, StaysConvexAndInShortNumbersAlongAnAxis) {
  Model model = with_compliances(sheet_model(), 2);
  for (ContactModel& contact : model.contacts) contact.chi2 = contact.condition = 1.5;
  const ScaledModel longer = scale_model(model, {.factor = 1.5, .axis = Vector3d(1, 0.2, 0.1)});
  EXPECT_EQ(longer.refitted, 4);
  EXPECT_EQ(longer.model.interpolation.rule, BlendRule::compliances);
  for (const ContactModel& contact : longer.model.contacts) {
    for (const Multiquadric& base : contact.field.bases) EXPECT_GE(base.weight, 0);
    EXPECT_EQ(contact.field, rounded(contact.field));
    EXPECT_EQ(contact.frame, rounded(contact).frame);
    EXPECT_TRUE(contact.compliance);
    EXPECT_EQ(contact.passivity, Passivity::convex);
    EXPECT_FALSE(contact.chi2 || contact.condition);  // not known of another field
  }
}

TEST(ScaleModel, KeepsWhatStrengthsSayBetweenContacts) {
  const Model model = with_strengths(sheet_model(), 2);
  const Model scaled = scale_model(model, {.factor = 2}).model;
  EXPECT_EQ(scaled.interpolation.rule, BlendRule::forces);
  EXPECT_NEAR(scaled.interpolation.reference_depth, 4, 1e-12);
  // Forces of the same material go with the square of its size.
  for (std::size_t i = 0; i < model.contacts.size(); ++i)
    EXPECT_NEAR(scaled.contacts[i].strength->value, 4 * model.contacts[i].strength->value, 1e-5);
}

TEST(ScaleModel, ForgetsCompliancesThatNobodyBlends) {
  Model model = with_compliances(sheet_model(), 2);
  model.interpolation = {};
  const Model scaled = scale_model(model, {.factor = 2}).model;
  EXPECT_EQ(scaled.interpolation, Interpolation{});
  for (const ContactModel& contact : scaled.contacts) EXPECT_FALSE(contact.compliance);
}

TEST(ScaleModel, RefusesFactorsAndAxesWithoutSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double factor : {0.0, -2.0, nan, std::numeric_limits<double>::infinity(), 1e306}) {
    EXPECT_THAT(refusal([&] { return scale_model(sheet_model(), {.factor = factor}); }),
                HasSubstr("factor"));
  }
  EXPECT_THAT(
      refusal([] { return scale_model(sheet_model(), {.factor = 2, .axis = Vector3d::Zero()}); }),
      HasSubstr("axis"));
}

}  // namespace
}  // namespace palpate::haptics
