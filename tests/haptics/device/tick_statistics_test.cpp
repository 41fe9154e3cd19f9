// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/tick_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::haptics {
namespace {

TEST(DurationHistogram, HasTheQuantilesToTwoPercent) {
  DurationHistogram histogram;
  std::vector<std::uint64_t> all;
  for (int i = 0; i < 5000; ++i) {
    all.push_back(static_cast<std::uint64_t>(200 * std::exp(8 * std::abs(std::sin(1.7 * i)))));
    histogram.add(all.back());
  }
  std::sort(all.begin(), all.end());
  EXPECT_EQ(histogram.count(), 5000U);
  EXPECT_EQ(histogram.largest(), all.back());
  for (const double part : {0.001, 0.5, 0.9, 0.999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(part * 5000)) - 1;
    const auto exact = static_cast<double>(all[rank]);
    EXPECT_GE(static_cast<double>(histogram.quantile(part)), exact);
    EXPECT_LE(static_cast<double>(histogram.quantile(part)), 1.02 * exact);
  }
}

TEST(DurationHistogram, TakesAnyNumber) {
  DurationHistogram histogram;
  EXPECT_EQ(histogram.quantile(0.5), 0U);
  histogram.add(0);
  EXPECT_EQ(histogram.quantile(1), 0U);
  histogram.add(~std::uint64_t{0});
  EXPECT_EQ(histogram.largest(), ~std::uint64_t{0});
  EXPECT_EQ(histogram.quantile(0.5), 0U);
}

}  // namespace
}  // namespace palpate::haptics
