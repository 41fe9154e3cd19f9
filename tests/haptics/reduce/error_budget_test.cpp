// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/error_budget.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/error_forecast.h"
#include "palpate/probing/closed_form.h"
#include "reduce/strokes.h"
#include "sphere_model.h"
#include "strip_acquisition.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

const probing::Sheet kSheet;
const support::StripProbing kProbing{.directions = 4};
constexpr double kRows = 20;  // [mm] contacts are at |y| up to this

/// \param shift [mm] of all that the arm measures
Model measured_sheet(const support::StripProbing& probing, const Vector3d& shift = {0, 0, 0}) {
  probing::Acquisition acquisition;
  support::StripProbe probe(kSheet, probing);
  for (const Eigen::Vector2d& at : support::strip_places(probing))
    if (std::abs(at.y()) <= kRows) probe.probe(acquisition, at.x(), at.y());
  for (probing::Contact& contact : acquisition.contacts) contact.position += shift;
  for (probing::Sample& sample : acquisition.samples) {
    sample.a += shift;
    sample.b += shift;
  }
  return build_model(probing::CheckedAcquisition(std::move(acquisition)),
                     probing::make_specimen(kSheet)->surface())
      .model;
}

/// A measured sheet, and what its model says of its errors. Sources of error are changed, and the
/// forces compared.
class BudgetOfASheet : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    model = std::make_unique<Model>(measured_sheet(kProbing));
    ReduceOptions needs;
    for (const auto& vertex : model->surface.vertices.colwise())
      needs.reachable.push_back(std::abs(vertex.x()) <= 42 && std::abs(vertex.y()) <= kRows);
    budget = ErrorForecast(*model, needs).budget_at_present();
    StrokeSettings strokes = stroke_settings(*model, needs);
    strokes.count = 1000;
    ends = play_strokes(*model, random_strokes(*model, strokes));
  }
  static void TearDownTestSuite() { model.reset(); }

  // [N] RMS over strokes, for the same tool in the world.
  static double difference_in_world(const Model& other) {
    const BlendedField one(*model), two(other);
    double sum = 0;
    for (const StrokeEnd& end : ends) {
      const Vector3d here = one.surface().closest_point(end.contact).position,
                     there = two.surface().closest_point(end.contact).position;
      sum += (one.force(here, end.tool - here) - two.force(there, end.tool - there)).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(ends.size()));
  }

  // [N] RMS over known forces between the contacts.
  static double difference_between_contacts(const Model& other) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<Eigen::Vector2d> places;
    for (int i = 0; i < 500; ++i) {
      const double x = 35 * uniform(random);
      places.emplace_back(x, 15 * uniform(random));
    }
    const BlendedField one(*model), two(other);
    double sum = 0;
    for (const support::StripTruth& truth : support::strip_truths(kSheet, places, 1)) {
      sum += (one.force(truth.contact, truth.displacement) -
              two.force(truth.contact, truth.displacement))
                 .squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(places.size()));
  }

  inline static std::unique_ptr<Model> model;
  inline static ErrorBudget budget;
  inline static std::vector<StrokeEnd> ends;
};

// The same noise with the other sign: half of the difference is what it causes. Some twenty
// contacts have scattered by 15 % then, and their fits may drop other bases.
TEST_F(BudgetOfASheet, TellsTheNoiseOfForcesFromThatOfPositions) {
  support::StripProbing forces = kProbing, positions = kProbing;
  forces.force_noise *= -1;
  positions.position_noise *= -1;
  positions.location_noise *= -1;
  const double of_forces = difference_between_contacts(measured_sheet(forces)) / 2,
               of_positions = difference_between_contacts(measured_sheet(positions)) / 2;
  EXPECT_GT(of_forces, 0.6 * budget.force_noise);
  EXPECT_LT(of_forces, 1.6 * budget.force_noise);
  EXPECT_GT(of_positions, 0.6 * budget.position_noise);
  EXPECT_LT(of_positions, 1.6 * budget.position_noise);
}

// Stiffness is linear over 0.1 mm, but at some ends near the border the contact is another.
TEST_F(BudgetOfASheet, ForetellsTheEffectOfAnOffsetOfTheSurface) {
  Model moved = *model;
  moved.surface.vertices.row(2).array() += 0.1;  // the sheet faces along z
  const double actual = difference_in_world(moved);
  EXPECT_NEAR(actual, 0.1 * budget.per_depth_offset, 0.05 * actual);
}

// A thousand ends are in as many triangles: noise itself scatters the result by some per cent.
TEST_F(BudgetOfASheet, ForetellsTheEffectOfNoiseOfTheDepths) {
  Model noisy = *model;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (auto vertex : noisy.surface.vertices.colwise()) vertex.z() += 0.05 * normal(random);
  const double actual = difference_in_world(noisy);
  EXPECT_NEAR(actual, 0.05 * budget.per_depth_noise, 0.1 * actual);
}

// The arm measures the same beside its place. Fields stay the same; compliances and weights between
// contacts are learnt again.
TEST_F(BudgetOfASheet, ForetellsTheEffectOfAShiftAlongTheSurface) {
  constexpr double kShifted = 0.3;  // [mm]
  const double along_x = difference_in_world(measured_sheet(kProbing, {kShifted, 0, 0})),
               along_y = difference_in_world(measured_sheet(kProbing, {0, kShifted, 0}));
  const double actual = std::hypot(along_x, along_y) / std::sqrt(2);
  EXPECT_NEAR(actual, kShifted * budget.per_registration, 0.15 * actual);
}

TEST_F(BudgetOfASheet, HasOnlyThePartsThatItsProbingLeaves) {
  EXPECT_EQ(budget.across, 0);  // the tool was dragged
  EXPECT_GT(budget.contrast, 0);
  EXPECT_LT(budget.fit, budget.force_noise);  // closed form, fitted to its noise
}

// Each contact states its errors, and its fit says how much of them noise explains.
TEST(ErrorBudget, PartsAddUpToWhatTheModelStates) {
  Model model = ball_model([](const Vector3d&) { return true; }, [](int) { return 0.5; }, 60, 4);
  model.noise = MeasurementNoise{.force = 0.01, .displacement = 0.02};
  for (ContactModel& contact : model.contacts) {
    contact.uncertainty =
        ContactUncertainty{.force = 0.02, .displacement = 0.03, .across = 0.1, .between = 0.004};
    contact.samples = 600;
    contact.noise_floor = 0.016;
    contact.chi2 = 2;  // the misfit is 0.016^2 (2 - 1 - 2 / 30)
  }
  const ReduceOptions needs{.largest_depth = 4, .strokes = 1000};
  const ErrorForecast forecast(model, needs);
  const ErrorBudget& of = forecast.budget_at_present();
  const double misfit = 0.016 * 0.016 * (1 - 2.0 / 30);
  EXPECT_NEAR(std::pow(of.fit / of.force_noise, 2), misfit / (0.02 * 0.02 - misfit), 1e-9);
  EXPECT_GT(of.position_noise, 0);
  EXPECT_GT(of.across, 0);
  EXPECT_GT(of.spacing, 0);

  StrokeSettings settings = stroke_settings(model, needs);
  settings.count = 200;  // a fifth of them: those of the forecast
  const BlendedField field(model);
  double squares = 0;
  const std::vector<StrokeEnd> ends = play_strokes(model, random_strokes(model, settings));
  for (const StrokeEnd& end : ends)
    squares += std::pow(*field.deviation(end.contact, end.tool - end.contact), 2);
  EXPECT_NEAR(of.stated(), std::sqrt(squares / static_cast<double>(ends.size())), 1e-9);
  EXPECT_EQ(forecast.at_present(), of.stated());
  EXPECT_NEAR(of.with({.depth_offset = 0.1, .registration = 0.2}),
              std::hypot(of.stated(), 0.1 * of.per_depth_offset, 0.2 * of.per_registration), 1e-12);
  EXPECT_NE(refusal([&] { return of.with({.depth_noise = -1}); }).find("depth_noise is -1"),
            std::string::npos);

  model.noise.reset();
  const ErrorBudget unknown = ErrorForecast(model, needs).budget_at_present();
  EXPECT_EQ(unknown.force_noise, 0);
  EXPECT_NEAR(unknown.fit, std::hypot(of.fit, of.force_noise), 1e-9);
}

// Four times as many contacts are half as far apart.
TEST(ErrorBudget, ChangesOnlyWhatLiesBetweenContactsWithTheirNumber) {
  Model model = ball_model([](const Vector3d&) { return true; }, [](int) { return 0.5; }, 60, 4);
  for (ContactModel& contact : model.contacts)
    contact.uncertainty = ContactUncertainty{.force = 0.02, .between = 0.004};
  const ErrorForecast forecast(model, {.largest_depth = 4, .strokes = 1000});
  const ErrorBudget before = forecast.budget_at_present(),
                    after = forecast.budget_with(places_on_sphere(240));
  EXPECT_EQ(after.fit, before.fit);
  EXPECT_EQ(after.per_depth_offset, before.per_depth_offset);
  EXPECT_NEAR(after.spacing / before.spacing, std::pow(0.5, 1.25), 0.04);
}

}  // namespace
}  // namespace palpate::haptics
