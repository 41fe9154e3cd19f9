// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/error_forecast.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/build_model.h"
#include "palpate/probing/closed_form.h"
#include "sphere_model.h"
#include "strip_acquisition.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

// A ball on which every contact states the same errors.
Model ball_with(const ContactUncertainty& uncertainty) {
  Model model = ball_model([](const Vector3d&) { return true; }, [](int) { return 0.5; }, 60, 4);
  for (ContactModel& contact : model.contacts) contact.uncertainty = uncertainty;
  return model;
}

const ReduceOptions kPresses{.largest_depth = 4, .strokes = 2000};

std::vector<Vector3d> contacts_of(const Model& model) {
  std::vector<Vector3d> places;
  for (const ContactModel& contact : model.contacts) places.push_back(contact.position);
  return places;
}

TEST(ErrorForecast, IsWhatTheModelStatesForItsOwnContacts) {
  const Model model = ball_with({.force = 0.02, .displacement = 0.03, .between = 0.004});
  const ErrorForecast forecast(model, kPresses);
  EXPECT_NEAR(forecast.with(contacts_of(model)), forecast.at_present(),
              0.01 * forecast.at_present());
  EXPECT_LT(forecast.of_contacts(), forecast.at_present());
}

// Four times as many contacts are half as far apart, and errors grow with the 1.25th power of the
// distance.
TEST(ErrorForecast, FallsWithTheDistanceBetweenContacts) {
  const ErrorForecast forecast(ball_with({.between = 0.004}), kPresses);
  EXPECT_NEAR(forecast.with(places_on_sphere(240)) / forecast.at_present(), std::pow(0.5, 1.25),
              0.04);
}

TEST(ErrorForecast, KeepsTheErrorsOfTheContacts) {
  const ErrorForecast forecast(ball_with({.force = 0.02, .displacement = 0.03}), kPresses);
  EXPECT_GT(forecast.of_contacts(), 0.02);
  EXPECT_NEAR(forecast.with(places_on_sphere(240)), forecast.of_contacts(), 1e-12);
}

TEST(ErrorForecast, DoesNotDependOnTheOrderOfContacts) {
  const ErrorForecast forecast(ball_with({.between = 0.004}), kPresses);
  std::vector<Vector3d> places = places_on_sphere(100);
  const double error = forecast.with(places);
  std::ranges::reverse(places);
  EXPECT_NEAR(forecast.with(places), error, 1e-6 * error);
}

// The forecast is made from 46 contacts of a sheet above a block; then it is measured with 95.
TEST(ErrorForecast, ForetellsTheErrorOfAModelWithMoreContacts) {
  const probing::Sheet object{.block = 1.5};
  const auto measured = [&](const support::StripProbing& probing) {
    return build_model(probing::CheckedAcquisition(support::strip_acquisition(object, probing)),
                       probing::make_specimen(object)->surface())
        .model;
  };
  const support::StripProbing dense{.spacing_x = 10.5, .spacing_y = 13.4, .directions = 4};
  support::StripProbing few = dense;
  few.spacing_x = 14;
  few.spacing_y = 20;
  const Model pilot = measured(few), model = measured(dense);

  std::vector<bool> between_contacts;
  for (const auto& vertex : pilot.surface.vertices.colwise())
    between_contacts.push_back(std::abs(vertex.x()) <= 42 && std::abs(vertex.y()) <= 60);
  const ErrorForecast forecast(pilot, {.reachable = between_contacts});
  const double expected = forecast.with(contacts_of(model)) / forecast.force();

  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Vector2d> places;
  for (int i = 0; i < 500; ++i) {
    const double x = 42 * uniform(random);
    places.emplace_back(x, 60 * uniform(random));
  }
  const BlendedField field(model);
  double error = 0, force = 0;
  for (const support::StripTruth& truth : support::strip_truths(object, places, 1)) {
    error += (field.force(truth.contact, truth.displacement) - truth.force).squaredNorm();
    force += truth.force.squaredNorm();
  }
  const double ratio = std::sqrt(error / force) / expected;
  EXPECT_GT(ratio, 0.7);
  EXPECT_LT(ratio, 1.4);
}

TEST(ErrorForecast, NeedsAModelThatStatesItsErrors) {
  Model model = ball_with({.between = 0.004});
  model.contacts.front().uncertainty.reset();
  EXPECT_THAT(refusal([&] { return ErrorForecast(model, kPresses).force(); }),
              HasSubstr("states no error"));
  EXPECT_THAT(
      refusal([&] {
        return ErrorForecast(ball_with({}), {.largest_depth = 4, .reachable = {true}}).force();
      }),
      HasSubstr("reachable has 1 values"));
}

}  // namespace
}  // namespace palpate::haptics
