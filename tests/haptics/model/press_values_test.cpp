// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/press_values.h"

#include <gtest/gtest.h>

#include <cmath>

#include "palpate/core/error.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/contact_compliance.h"
#include "palpate/haptics/contact_strength.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

constexpr double kPressDepth = 3;
constexpr double kPressRounding = 1e-12;  // some ten operations on values of order 1 to 1000

TEST(PressValues, OfASpringAreItsForceAndItsSlopeAtTheDepth) {
  // f = 4 d / sqrt(d^2 + 100) along the displacement, at every place.
  const Model model = moved(sheet_model(), some_motion());
  const PressValues values = press_values(model, kPressDepth);
  ASSERT_EQ(values.force.size(), model.surface.vertices.cols());
  const double root = std::sqrt(kPressDepth * kPressDepth + 100);
  int known = 0;
  for (Eigen::Index i = 0; i < values.force.size(); ++i) {
    EXPECT_TRUE(std::isnan(values.deviation[i]));  // of which the model says nothing
    if (std::isnan(values.force[i])) continue;
    ++known;
    EXPECT_NEAR(values.force[i], 4 * kPressDepth / root, kPressRounding);
    EXPECT_NEAR(values.stiffness[i], 400 / std::pow(root, 3), kPressRounding);
  }
  EXPECT_GT(known, values.force.size() / 4);
}

TEST(PressValues, HaveTheSlopeOfTheForceOverTheDepthWhereAContactHasInfluence) {
  const Model model = uneven_model();
  const double step = 1e-4;
  const PressValues values = press_values(model, kPressDepth),
                    less = press_values(model, kPressDepth - step),
                    more = press_values(model, kPressDepth + step);
  const BlendedField field(model);
  for (Eigen::Index i = 0; i < values.force.size(); ++i) {
    const bool is_known = field.blend(model.surface.vertices.col(i)).contacts.count > 0;
    EXPECT_EQ(std::isfinite(values.force[i]), is_known);
    EXPECT_EQ(std::isfinite(values.stiffness[i]), is_known);
    if (!is_known) continue;
    EXPECT_NEAR(values.stiffness[i], (more.force[i] - less.force[i]) / (2 * step), 1e-6);
  }
}

TEST(PressValues, HaveTheDeviationOfTheForceWhereTheModelStatesIt) {
  Model model = uneven_model();
  for (ContactModel& contact : model.contacts) contact.uncertainty = {.force = 0.3};
  const PressValues values = press_values(model, kPressDepth);
  const BlendedField field(model);
  for (Eigen::Index i = 0; i < values.force.size(); ++i) {
    const Blend at = field.blend(model.surface.vertices.col(i));
    const auto deviation =
        field.deviation(model.surface.vertices.col(i), kPressDepth * at.field_frame.col(2));
    ASSERT_EQ(deviation.has_value(), std::isfinite(values.deviation[i]));
    if (!deviation) continue;
    EXPECT_NEAR(values.deviation[i], *deviation, kPressRounding);
  }
}

TEST(PressValues, RefuseADepthThatIsNone) {
  for (const double depth : {0.0, -1.0, std::nan("")})
    EXPECT_THROW((void)press_values(sheet_model(), depth), InvalidInput);
}

TEST(ReferencePressDepth, IsThatAtWhichTheModelComparesItsContacts) {
  EXPECT_EQ(reference_press_depth(sheet_model()), std::nullopt);
  EXPECT_EQ(reference_press_depth(with_strengths(sheet_model(), 2.5)), 2.5);
  // 4 d / sqrt(d^2 + 100) = 2 N at d = 10 / sqrt(3).
  EXPECT_NEAR(reference_press_depth(with_compliances(sheet_model(), 2)).value(),
              10 / std::sqrt(3.0), kForceRounding);
}

}  // namespace
}  // namespace palpate::haptics
