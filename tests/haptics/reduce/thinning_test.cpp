// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/thinning.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using ::testing::Contains;

// Thinned to a difference of `error` [N] in presses of up to 3 mm.
ThinnedContacts thinned(const Model& model, double error,
                        std::vector<std::size_t> candidates = {}) {
  if (candidates.empty()) {
    candidates.resize(model.contacts.size());
    std::iota(candidates.begin(), candidates.end(), std::size_t{0});
  }
  const std::vector<Stroke> strokes =
      random_strokes(model, {.count = 500, .largest_depth = 3, .drags = false});
  return thin_contacts(model, candidates, strokes, play_strokes(model, strokes), error, [] {});
}

TEST(ThinContacts, LeavesFewOfAnObjectThatIsTheSameEverywhere) {
  const Model model = grid_model(14, [](double, double) { return spring(4, 10); });
  const ThinnedContacts result = thinned(model, 1e-3);
  EXPECT_LE(result.kept.size(), 6U);
  EXPECT_LT(result.error, 1e-9);
  EXPECT_EQ(result.model.contacts.size(), result.kept.size());
}

TEST(ThinContacts, KeepsTheContactThatTheOthersDoNotPredict) {
  const Model model =
      grid_model(14, [](double x, double y) { return spring(x == 14 && y == -14 ? 9 : 4, 10); });
  std::size_t hard = 0;
  while (model.contacts[hard].field.bases[0].weight != 9) ++hard;
  const ThinnedContacts result = thinned(model, 0.05);
  EXPECT_THAT(result.kept, Contains(hard));
  EXPECT_LT(result.kept.size(), model.contacts.size() / 2);
}

TEST(ThinContacts, KeepsMoreContactsForASmallerError) {
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

TEST(ThinContacts, KeepsAllForNoErrorAtAll) {
  const Model model = grid_model(21, [](double x, double y) {
    return spring(4 + std::sin(0.2 * x) * std::cos(0.17 * y), 10);
  });
  const ThinnedContacts result = thinned(model, 0);
  EXPECT_EQ(result.kept.size(), model.contacts.size());
  EXPECT_EQ(result.error, 0);
}

}  // namespace
}  // namespace palpate::haptics
