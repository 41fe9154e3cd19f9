// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/error_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "not_finite.h"

namespace palpate::geometry {
namespace {

TEST(ErrorStatistics, OfKnownValues) {
  const ErrorStatistics s = error_statistics({3, -4, 0, 1, -2});
  EXPECT_EQ(s.count, 5);
  EXPECT_DOUBLE_EQ(s.rms, std::sqrt(30.0 / 5));
  EXPECT_DOUBLE_EQ(s.median, 2);
  EXPECT_DOUBLE_EQ(s.p90, 3.6);  // between 3 and 4
  EXPECT_DOUBLE_EQ(s.p95, 3.8);
  EXPECT_DOUBLE_EQ(s.max, 4);
}

TEST(ErrorStatistics, DoNotDependOnOrderAndLeaveOutWhatIsNotFinite) {
  const ErrorStatistics a = error_statistics({0.1, 0.7, 1000.1, -0.3});
  const ErrorStatistics b =
      error_statistics({1000.1, kNaN, -0.3, 0.1, 0.7, std::numeric_limits<double>::infinity()});
  EXPECT_EQ(a.count, b.count);
  EXPECT_EQ(a.rms, b.rms);
  EXPECT_EQ(a.median, b.median);
}

TEST(ErrorStatistics, OfNothingAreNaN) {
  const ErrorStatistics s = error_statistics({kNaN});
  EXPECT_EQ(s.count, 0);
  EXPECT_TRUE(std::isnan(s.rms) && std::isnan(s.median) && std::isnan(s.p90) && std::isnan(s.max));
}

}  // namespace
}  // namespace palpate::geometry
