// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/contact_losses.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "palpate/core/quantile.h"
#include "reduce/contact_subset.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

double sum_of_squares(const std::vector<double>& values) {
  return std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
}

TEST(ContactLosses, AreThoseOfAllStrokesWithoutTheContact) {
  const Model full = grid_model(14, [](double x, double y) {
    return spring(4 + std::sin(0.1 * x) * std::cos(0.07 * y), 10);
  });
  const std::vector<Stroke> strokes =
      random_strokes(full, {.count = 800, .largest_depth = 3, .drags = true});
  const std::vector<StrokeEnd> ends = play_strokes(full, strokes);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < full.contacts.size(); i += 2) kept.push_back(i);
  const Model model = with_contacts(full, kept);
  const std::vector<double> differences = force_differences(ends, play_strokes(model, strokes));

  const std::vector<double> losses = contact_losses(model, strokes, ends, differences);
  ASSERT_EQ(losses.size(), kept.size());
  double largest = 0;
  std::vector<double> errors;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    std::vector<std::size_t> rest = kept;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
    const std::vector<double> without =
        force_differences(ends, play_strokes(with_contacts(full, rest), strokes));
    const double loss = sum_of_squares(without) - sum_of_squares(differences);
    largest = std::max(largest, loss);
    errors.push_back(std::abs(losses[k] - loss));
  }
  // A triangulation that is made again may join some of the others differently: that is not lost.
  constexpr double kMedianError = 0.02, kLargestError = 0.5;
  EXPECT_LT(median(errors), kMedianError * largest);
  EXPECT_LT(std::ranges::max(errors), kLargestError * largest);
}

TEST(ContactLosses, AreZeroWhereTheOthersPredictAContact) {
  const Model full = grid_model(21, [](double, double) { return spring(4, 10); });
  const std::vector<Stroke> strokes =
      random_strokes(full, {.count = 300, .largest_depth = 3, .drags = false});
  const std::vector<StrokeEnd> ends = play_strokes(full, strokes);
  const std::vector<double> differences(ends.size(), 0);
  for (const double loss : contact_losses(full, strokes, ends, differences))
    EXPECT_NEAR(loss, 0, 1e-9);
}

}  // namespace
}  // namespace palpate::haptics
