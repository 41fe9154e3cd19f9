// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "palpate/haptics/contact_compliance.h"
#include "palpate/haptics/contact_strength.h"
#include "palpate/haptics/playback.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

// The same object in other units: lengths and forces are multiplied by these.
Model in_units(Model model, double length, double force) {
  model.surface.vertices *= length;
  for (ContactModel& contact : model.contacts) {
    contact.position *= length;
    for (Multiquadric& base : contact.field.bases) {
      base.weight *= force;
      base.epsilon *= length;
      base.center *= length;
    }
  }
  return model;
}

void expect_proportional(const PlaybackOptions& options, const PlaybackOptions& usual,
                         double length, double force) {
  EXPECT_DOUBLE_EQ(*options.tolerance, force * *usual.tolerance);
  // Depths of compliances are rounded.
  EXPECT_NEAR(*options.energy_credit / (length * force * *usual.energy_credit), 1, 1e-6);
  EXPECT_DOUBLE_EQ(*options.largest_jump, force * *usual.largest_jump);
  EXPECT_DOUBLE_EQ(*options.start_depth, length * *usual.start_depth);
}

TEST(PlaybackOptions, FollowTheSizeOfTheModelAndTheForcesThatWereMeasured) {
  const Model model = sheet_model();
  constexpr double kLength = 0x1p-7, kForce = 0x1p10;
  const Model other = in_units(model, kLength, kForce);
  expect_proportional(playback_options_for(other, {}), playback_options_for(model, {}), kLength,
                      kForce);
  expect_proportional(playback_options_for(with_compliances(other, 2 * kForce), {}),
                      playback_options_for(with_compliances(model, 2), {}), kLength, kForce);
  expect_proportional(playback_options_for(with_strengths(other, 3 * kLength), {}),
                      playback_options_for(with_strengths(model, 3), {}), kLength, kForce);
}

TEST(PlaybackOptions, AreDerivedFromTheForceAndTheDepthThatWereMeasured) {
  const Model model = with_compliances(sheet_model(), 2);
  // 4 d / sqrt(d^2 + 10^2) = 2
  const double depth = 10 / std::sqrt(3.0);
  const PlaybackOptions options = playback_options_for(model, {});
  EXPECT_DOUBLE_EQ(*options.tolerance, 1e-4);
  EXPECT_NEAR(*options.energy_credit, 0.0015 * depth, 1e-6);
  EXPECT_DOUBLE_EQ(*options.largest_jump, 0.06);
  EXPECT_DOUBLE_EQ(*options.start_depth, 0.1 * geometry::bounding_diagonal(model.surface));
}

TEST(PlaybackOptions, KeepTheValuesThatAreSet) {
  const PlaybackOptions given{
      .tolerance = 1e-3, .energy_credit = 0.0, .largest_jump = 0.5, .start_depth = 7.0};
  EXPECT_EQ(playback_options_for(sheet_model(), given), given);
}

TEST(PlaybackOptions, AreUsableForAModelWithoutForces) {
  Model model = sheet_model();
  for (ContactModel& contact : model.contacts) contact.field.bases.clear();
  const PlaybackOptions options = playback_options_for(model, {});
  EXPECT_GT(*options.tolerance, 0);
  EXPECT_GT(*options.largest_jump, 0);
}

}  // namespace
}  // namespace palpate::haptics
