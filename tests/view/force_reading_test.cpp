// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "force_reading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "sheet_model.h"

namespace palpate::view {
namespace {

// The sheet's contacts are springs f = 4 d / sqrt(d^2 + 100) along the displacement; mu = 0.5.
TEST(ForceReading, SaysWhatTheFieldsDoAtTheContact) {
  const haptics::Model model = haptics::sheet_model();
  const haptics::BlendedField field(model);
  const Eigen::Vector3d contact(10, 5, 700), displacement(0.5, 0, 3);
  FeltTick tick;
  tick.contact = contact;
  tick.tool = contact + displacement;
  tick.force = -field.force(contact, displacement);
  tick.state = haptics::ContactState::stick;
  const ForceReading reading = read_force(field, tick);
  const double depth = displacement.norm(), size = 4 * depth / std::sqrt(depth * depth + 100);
  EXPECT_NEAR(reading.total, size, 1e-9);
  EXPECT_NEAR(reading.normal, size * 3 / depth, 1e-9);
  EXPECT_NEAR(reading.tangential, size * 0.5 / depth, 1e-9);
  EXPECT_NEAR(reading.friction, 0.5, 1e-12);
  EXPECT_NEAR((reading.inwards - Eigen::Vector3d(0, 0, 1)).norm(), 0, 1e-12);
  EXPECT_EQ(reading.displacement, displacement);
  EXPECT_NEAR((geometry::position(model.surface, reading.at) - contact).norm(), 0, 1e-9);
  const auto weights =
      std::span(reading.weights.weights).first(static_cast<std::size_t>(reading.weights.count));
  EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1, 1e-9);
}

TEST(ForceReading, IsZeroWhileTheToolIsFree) {
  const haptics::BlendedField field(haptics::sheet_model());
  const ForceReading reading = read_force(field, {});
  EXPECT_EQ(reading.total, 0);
  EXPECT_EQ(reading.weights.count, 0);
  EXPECT_FALSE(reading.deviation.has_value());
}

TEST(PressTrial, GoesAsDeepAsTheForceGrows) {
  const haptics::Model model = haptics::sheet_model();
  const haptics::Playback playback(model);
  const PressTrial trial = try_presses(playback, model, 15);
  EXPECT_EQ(trial.depth, 15) << "these springs grow without end";
  EXPECT_EQ(trial.force, round_up(4 * 15 / std::sqrt(15 * 15 + 100.0)));
}

TEST(PressTrial, StopsWhereTheForceFallsAgain) {
  haptics::Model model = haptics::sheet_model();
  // p = 6 (sqrt(d^2 + 4) - 2) - 5 (sqrt(d^2 + 25) - 5) grows slower from some depth on.
  for (haptics::ContactModel& contact : model.contacts) contact.field = {{{6, 2}, {-5, 5}}};
  const auto force = [](double d) {
    return 6 * d / std::sqrt(d * d + 4) - 5 * d / std::sqrt(d * d + 25);
  };
  double top = 0;
  for (double d = 0; d < 15; d += 0.001) top = force(d) > force(top) ? d : top;
  ASSERT_LT(top, 10);
  const PressTrial trial = try_presses(haptics::Playback(model), model, 15);
  EXPECT_NEAR(trial.depth, top, 0.15 + 1e-3) << "to one of a hundred steps";
}

TEST(RoundUp, GivesTheNextOfOneTwoFive) {
  EXPECT_EQ(round_up(1), 1);
  EXPECT_NEAR(round_up(1.01), 2, 1e-12);
  EXPECT_NEAR(round_up(0.021), 0.05, 1e-12);
  EXPECT_NEAR(round_up(600), 1000, 1e-9);
}

}  // namespace
}  // namespace palpate::view
