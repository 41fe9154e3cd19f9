// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/thinning.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "palpate/geometry/error_statistics.h"
#include "reduce/contact_subset.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using ::testing::Contains;

std::vector<Stroke> shallow_presses(const Model& model) {
  return random_strokes(model, {.count = 500, .largest_depth = 3, .drags = false});
}

std::vector<std::size_t> all_contacts(const Model& model) {
  std::vector<std::size_t> all(model.contacts.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

// Thinned to a difference of `error` [N] in presses of up to 3 mm.
ThinnedContacts thinned(const Model& model, double error) {
  const std::vector<Stroke> strokes = shallow_presses(model);
  const std::vector<StrokeEnd> ends = play_strokes(model, strokes);
  return ContactThinning(model, all_contacts(model), strokes, ends).within(error, [] {});
}

TEST(ContactThinning, LeavesFewOfAnObjectThatIsTheSameEverywhere) {
  const Model model = grid_model(14, [](double, double) { return spring(4, 10); });
  const ThinnedContacts result = thinned(model, 1e-3);
  EXPECT_EQ(result.kept.size(), 3U);  // a triangle
  EXPECT_LT(result.error, 1e-9);
  EXPECT_EQ(result.model.contacts.size(), result.kept.size());
}

TEST(ContactThinning, KeepsTheContactThatTheOthersDoNotPredict) {
  const Model model =
      grid_model(14, [](double x, double y) { return spring(x == 14 && y == -14 ? 9 : 4, 10); });
  std::size_t hard = 0;
  while (model.contacts[hard].field.bases[0].weight != 9) ++hard;
  const ThinnedContacts result = thinned(model, 0.05);
  EXPECT_THAT(result.kept, Contains(hard));
  EXPECT_LT(result.kept.size(), model.contacts.size() / 2);
}

TEST(ContactThinning, KeepsMoreContactsForASmallerError) {
  const Model model = grid_model(14, [](double x, double y) {
    return spring(4 + std::sin(0.08 * x) * std::cos(0.06 * y), 10);
  });
  std::size_t before = 0;
  for (const double error : {0.3, 0.1, 0.03, 0.01}) {
    const ThinnedContacts result = thinned(model, error);
    EXPECT_LE(result.error, error);
    EXPECT_GE(result.kept.size(), before);
    before = result.kept.size();
  }
  EXPECT_GT(before, 12U);
}

TEST(ContactThinning, KeepsNoContactThatMayLeaveAlone) {
  const Model model = grid_model(14, [](double x, double y) {
    return spring(4 + std::sin(0.08 * x) * std::cos(0.06 * y), 10);
  });
  const std::vector<Stroke> strokes = shallow_presses(model);
  const std::vector<StrokeEnd> ends = play_strokes(model, strokes);
  constexpr double kError = 0.05;
  const std::vector<std::size_t> kept =
      ContactThinning(model, all_contacts(model), strokes, ends).within(kError, [] {}).kept;
  std::size_t may_leave = 0;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    std::vector<std::size_t> rest = kept;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
    const auto differences =
        force_differences(ends, play_strokes(with_contacts(model, rest), strokes));
    if (geometry::error_statistics(differences).rms <= kError) ++may_leave;
  }
  // Losses are estimated at the ends of strokes, so one may be overestimated.
  EXPECT_LE(may_leave, 1U);
}

TEST(ContactThinning, PlaysNoChoiceOfContactsAgainForAnotherError) {
  const Model model = grid_model(14, [](double x, double y) {
    return spring(4 + std::sin(0.08 * x) * std::cos(0.06 * y), 10);
  });
  const std::vector<Stroke> strokes = shallow_presses(model);
  const std::vector<StrokeEnd> ends = play_strokes(model, strokes);
  int played = 0;
  const auto count = [&] { ++played; };
  ContactThinning thinning(model, all_contacts(model), strokes, ends);
  for (const double error : {0.3, 0.03, 0.1}) {
    const ThinnedContacts result = thinning.within(error, count), alone = thinned(model, error);
    EXPECT_EQ(result.kept, alone.kept);
    EXPECT_EQ(result.error, alone.error);
  }
  const int once = played;
  static_cast<void>(thinning.within(0.03, count));
  EXPECT_EQ(played, once);
}

TEST(ContactThinning, KeepsAllForNoErrorAtAll) {
  const Model model = grid_model(21, [](double x, double y) {
    return spring(4 + std::sin(0.2 * x) * std::cos(0.17 * y), 10);
  });
  const ThinnedContacts result = thinned(model, 0);
  EXPECT_EQ(result.kept.size(), model.contacts.size());
  EXPECT_EQ(result.error, 0);
}

}  // namespace
}  // namespace palpate::haptics
