// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/reduced_uncertainty.h"

#include <gtest/gtest.h>

#include "palpate/haptics/blended_field.h"
#include "reduce/contact_subset.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

Model plate() {
  Model model = grid_model(14, [](double x, double y) {
    return spring(4 + std::sin(0.08 * x) * std::cos(0.06 * y), 10);
  });
  for (ContactModel& contact : model.contacts)
    contact.uncertainty = {.force = 0.01, .displacement = 0, .across = 0, .between = 1e-4};
  return model;
}

std::vector<StrokeEnd> ends_of(const Model& model) {
  return play_strokes(model,
                      random_strokes(model, {.count = 1000, .largest_depth = 3, .drags = false}));
}

TEST(StatedError, IsTheRootMeanSquareOfDeviations) {
  Model model = plate();
  const std::vector<StrokeEnd> ends = ends_of(model);
  const BlendedField field(model);
  double sum = 0;
  for (const StrokeEnd& end : ends)
    sum += std::pow(*field.deviation(end.contact, end.tool - end.contact), 2);
  EXPECT_NEAR(*stated_error(model, ends), std::sqrt(sum / static_cast<double>(ends.size())), 1e-12);
  model.contacts[3].uncertainty.reset();
  EXPECT_FALSE(stated_error(model, ends));
}

TEST(StateReducedErrors, StaysWhereNothingWasReduced) {
  const Model model = plate();
  const std::vector<StrokeEnd> ends = ends_of(model);
  Model same = model;
  state_reduced_errors(model, ends, same);
  // Values are 1.12 apart.
  EXPECT_NEAR(*stated_error(same, ends) / *stated_error(model, ends), 1, 0.08);
}

TEST(StateReducedErrors, LeavesContactsThatNoStrokeTellsOf) {
  const Model model = plate();
  std::vector<StrokeEnd> ends = ends_of(model);
  std::erase_if(ends, [](const StrokeEnd& end) { return end.contact.x() > -20; });
  Model same = model;
  state_reduced_errors(model, ends, same);
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    if (!(model.contacts[i].position.x() > 0)) continue;
    EXPECT_EQ(same.contacts[i].uncertainty->between, model.contacts[i].uncertainty->between);
  }
}

// The full model is true up to 0.01 N; the errors of the other one are known, at other places.
TEST(StateReducedErrors, SaysHowFarTheReducedModelIsOff) {
  const Model model = plate();
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < model.contacts.size(); i += 3) kept.push_back(i);
  Model reduced = with_contacts(model, kept);
  for (ContactModel& contact : reduced.contacts) contact.uncertainty->between = 0;
  state_reduced_errors(model, ends_of(model), reduced);
  const std::vector<Stroke> strokes =
      random_strokes(model, {.count = 1000, .seed = 1U << 20, .largest_depth = 3, .drags = false});
  const std::vector<StrokeEnd> others = play_strokes(model, strokes);
  double sum = 0;
  for (const double difference : force_differences(others, play_strokes(reduced, strokes)))
    sum += difference * difference;
  const double actual = std::sqrt(sum / static_cast<double>(others.size()) + 0.01 * 0.01);
  EXPECT_GT(*stated_error(reduced, others) / actual, 0.7);
  EXPECT_LT(*stated_error(reduced, others) / actual, 1.4);
}

}  // namespace
}  // namespace palpate::haptics
