// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/contact_strength.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "hump_model.h"
#include "palpate/haptics/blended_field.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using ::testing::HasSubstr;

constexpr double kDepth = 6;  // [mm] the reference depth

TEST(WithStrengths, TakesTheMeanForceOfAPress) {
  const Model model = with_strengths(hump_model(14), kDepth);
  EXPECT_EQ(model.interpolation.rule, BlendRule::forces);
  EXPECT_EQ(model.interpolation.reference_depth, kDepth);
  EXPECT_NEAR(model.interpolation.reach, 28, 1e-9);
  for (const ContactModel& contact : model.contacts) {
    constexpr int kSteps = 1000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
      sum += force(contact.field, {0, 0, (i + 0.5) * kDepth / kSteps}).z();
    ASSERT_TRUE(contact.strength);
    EXPECT_NEAR(contact.strength->value, sum / kSteps, 1e-5);
  }
}

TEST(WithStrengths, PredictAHumpFarBetterThanLinearWeights) {
  const double linear = worst_error_of_hump(hump_model(14));
  const double kriged = worst_error_of_hump(with_strengths(hump_model(14), kDepth));
  EXPECT_GT(linear, 0.1);
  EXPECT_LT(kriged, 0.5 * linear);
  // Linear weights are of second order in the spacing, the trends of a higher one.
  EXPECT_LT(worst_error_of_hump(with_strengths(hump_model(7), kDepth)),
            0.25 * worst_error_of_hump(hump_model(7)));
}

TEST(WithStrengths, KeepsEachContactsFieldAtItsPlaceAndDoesNotJumpBetween) {
  const Model model = with_strengths(hump_model(14), kDepth);
  const BlendedField field(model);
  const Eigen::Vector3d displacement(1.1, -0.7, 5);
  for (const ContactModel& contact : model.contacts) {
    EXPECT_LT(
        (field.force(contact.position, displacement) - force(contact.field, displacement)).norm(),
        1e-9);
  }
  Eigen::Vector3d before = field.force({-50, -33, 700}, displacement);
  const double step = 1e-3;
  for (double t = -50; t <= 50; t += step) {
    const Eigen::Vector3d now = field.force({t, 0.66 * t, 700}, displacement);
    EXPECT_LT((now - before).norm(), step) << t;
    before = now;
  }
}

TEST(WithStrengths, MovesWithTheWorldAndDoesNotDependOnATurnOfTheLocalAxes) {
  const Model model = hump_model(14);
  const BlendedField field(with_strengths(model, kDepth));
  const Eigen::Isometry3d motion = some_motion();
  Model other = moved(model, motion);
  const Eigen::Matrix3d turn = rotation_exp({0, 0, 0.6});
  for (ContactModel& contact : other.contacts) {
    contact.frame = contact.frame * turn;
    contact.field = rotated(std::move(contact.field), turn.transpose());
  }
  const BlendedField elsewhere(with_strengths(other, kDepth));
  const Eigen::Vector3d displacement(1, -2, 5);
  const Eigen::Matrix3Xd places = random_points(20, 40);
  for (const auto& at : places.colwise()) {
    const Eigen::Vector3d place(at.x(), at.y(), 700);
    const Eigen::Vector3d expected = motion.linear() * field.force(place, displacement);
    EXPECT_LT((elsewhere.force(motion * place, motion.linear() * displacement) - expected).norm(),
              1e-3);
  }
}

TEST(WithStrengths, OfAnObjectThatIsTheSameEverywhereChangesNothing) {
  Model model = hump_model(14);
  for (ContactModel& contact : model.contacts) contact.field = hump_field(0, 0);
  const BlendedField field(with_strengths(model, kDepth));
  const Eigen::Vector3d displacement(1, 1, 4);
  for (double x = -48; x <= 48; x += 3.7) {
    EXPECT_LT((field.force({x, 0.3 * x, 700}, displacement) - force(hump_field(0, 0), displacement))
                  .norm(),
              1e-9);
  }
}

TEST(WithStrengths, RefusesADepthThatIsNotPositive) {
  for (const double wrong : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THAT(refusal([&] { return with_strengths(hump_model(28), wrong); }),
                HasSubstr("reference_depth"));
  }
}

}  // namespace
}  // namespace palpate::haptics
