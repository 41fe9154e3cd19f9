// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/joined_regions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>

namespace palpate::sensing {
namespace {

constexpr long kStripRows = 60;
constexpr long kStripColumns = 200;
constexpr int kWidestGap = 50;

/// Strips of one surface, 30 px wide and 40 px apart, with labels 0, 1, 2 from the left. The phase
/// bends as that of a ball does; strip i lacks `missing(i, row)` turns.
Regions strips(const std::function<double(long strip, long row)>& missing) {
  Regions regions{Labels::Constant(kStripRows, kStripColumns, -1),
                  Plane::Zero(kStripRows, kStripColumns), 3};
  for (long row = 0; row < kStripRows; ++row) {
    for (long column = 0; column < kStripColumns; ++column) {
      const long strip = column / 70;
      if (column % 70 >= 30) continue;
      const auto c = static_cast<double>(column);
      const double phase = 0.2 * static_cast<double>(row) + 0.1 * c - 4e-4 * c * c;
      regions.label(row, column) = static_cast<int>(strip);
      regions.phase(row, column) =
          static_cast<float>(phase - 2 * std::numbers::pi * missing(strip, row));
    }
  }
  return regions;
}

JoinedRegions join(const Regions& regions, const std::vector<std::uint8_t>& open) {
  JoinedRegions joined;
  join_regions(regions, open, kWidestGap, joined);
  return joined;
}

TEST(JoinedRegions, ContinueABentSurfaceAcrossDarkStripes) {
  const JoinedRegions joined = join(
      strips([](long strip, long) { return 3.0 * static_cast<double>(strip) - 2; }), {1, 1, 1});
  EXPECT_EQ(joined.count, 1);
  EXPECT_EQ(joined.group, (std::vector<int>{0, 0, 0}));
  EXPECT_EQ(joined.turns[1] - joined.turns[0], 3);
  EXPECT_EQ(joined.turns[2] - joined.turns[0], 6);
}

TEST(JoinedRegions, EndAtAStepThatIsNoWholeNumberOfTurns) {
  const JoinedRegions joined =
      join(strips([](long strip, long) { return strip == 2 ? 1.4 : 0.0; }), {1, 1, 1});
  EXPECT_EQ(joined.count, 2);
  EXPECT_EQ(joined.group[0], joined.group[1]);
  EXPECT_NE(joined.group[1], joined.group[2]);
}

TEST(JoinedRegions, EndWhereTheRowsDisagreeOnTheTurns) {
  const JoinedRegions joined =
      join(strips([](long strip, long row) { return strip == 2 && row % 4 == 0 ? 1.0 : 0.0; }),
           {1, 1, 1});
  EXPECT_EQ(joined.count, 2);
  EXPECT_NE(joined.group[1], joined.group[2]);
}

TEST(JoinedRegions, LeaveOutClosedRegionsAndDoNotCrossThem) {
  const JoinedRegions joined = join(strips([](long, long) { return 0.0; }), {1, 0, 1});
  EXPECT_EQ(joined.count, 2);
  EXPECT_EQ(joined.group[1], JoinedRegions::kNone);
  EXPECT_NE(joined.group[0], joined.group[2]);
}

TEST(JoinedRegions, DoNotCrossWiderGaps) {
  JoinedRegions joined;
  join_regions(strips([](long, long) { return 0.0; }), {1, 1, 1}, 39, joined);
  EXPECT_EQ(joined.count, 3);
}

TEST(PhaseEnd, IsTheLineThroughTheEndOfARun) {
  const Regions regions = strips([](long, long) { return 0.0; });
  const auto right = phase_end(regions, 10, 29, -1);
  const auto left = phase_end(regions, 10, 70, 1);
  ASSERT_TRUE(right && left);
  // The middle of the pixels that are used is 7.5 px inside.
  EXPECT_NEAR(right->slope, 0.1 - 8e-4 * 21.5, 1e-5);
  EXPECT_NEAR(left->slope, 0.1 - 8e-4 * 77.5, 1e-5);
  EXPECT_NEAR(left->phase, static_cast<double>(regions.phase(10, 70)), 0.03);
  EXPECT_FALSE(phase_end(regions, 10, 5, -1));
}

}  // namespace
}  // namespace palpate::sensing
