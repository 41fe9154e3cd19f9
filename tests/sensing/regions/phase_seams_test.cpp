// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/phase_seams.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace palpate::sensing {
namespace {

constexpr SeamLimits kSeamLimits{.min_width = 1, .max_width = 6, .min_agreement = 0.8};
constexpr long kSeamRows = 60;
constexpr long kSeamColumns = 90;

/// Region 0 on the left, solved with 5 turns; a seam from column 40 on; region
/// 1 on the right of it, whose phase lacks 3 turns and `step(row)` of the
/// continuation.
struct TwoSides {
  explicit TwoSides(
      long seam, const std::function<double(long row)>& step = [](long) { return 0.0; }) {
    regions.count = 2;
    regions.label = Labels::Constant(kSeamRows, kSeamColumns, -1);
    regions.phase = Plane::Zero(kSeamRows, kSeamColumns);
    for (long row = 0; row < kSeamRows; ++row) {
      for (long column = 0; column < kSeamColumns; ++column) {
        const auto r = static_cast<double>(row);
        const auto c = static_cast<double>(column);
        double phase = 0.3 * r + 0.2 * c + 1e-3 * c * c;
        if (column < 40) {
          regions.label(row, column) = 0;
        } else if (column >= 40 + seam) {
          regions.label(row, column) = 1;
          phase += 2 * std::numbers::pi * (step(row) - 3);
        }
        regions.phase(row, column) = static_cast<float>(phase);
      }
    }
    offsets[0] = {5 * 2 * std::numbers::pi, Reason::reconstructed};
  }
  Regions regions;
  std::vector<RegionOffset> offsets = std::vector<RegionOffset>(2);
};

RegionOffset solved(TwoSides sides, const SeamLimits& limits = kSeamLimits) {
  solve_from_neighbours(sides.regions, limits, sides.offsets);
  EXPECT_EQ(sides.offsets[0].phase, 5 * 2 * std::numbers::pi);
  return sides.offsets[1];
}

TEST(PhaseSeams, ARegionWithoutStripeEdgesContinuesItsNeighbour) {
  for (const long seam : {1L, 3L, 6L}) {
    const RegionOffset offset = solved(TwoSides(seam));
    ASSERT_TRUE(offset.phase) << seam;
    EXPECT_DOUBLE_EQ(*offset.phase, 8 * 2 * std::numbers::pi);
    EXPECT_EQ(offset.reason, Reason::reconstructed);
  }
}

TEST(PhaseSeams, AWideSeamMayBeTheShadowOfAStepByWholePeriods) {
  const RegionOffset offset = solved(TwoSides(7));
  EXPECT_FALSE(offset.phase);
  EXPECT_EQ(offset.reason, Reason::no_transition);
}

TEST(PhaseSeams, AStepBetweenWholeNumbersOfTurnsSolvesNothing) {
  for (const double step : {0.5, 0.25, -0.15, 0.06}) {
    const RegionOffset offset = solved(TwoSides(3, [&](long) { return step; }));
    EXPECT_FALSE(offset.phase) << step;
    EXPECT_EQ(offset.reason, Reason::no_transition) << step;
  }
}

TEST(PhaseSeams, AStepWhoseHeightVariesIsNeverTakenForASeam) {
  for (const double range : {0.5, 1.0, 2.0}) {
    const RegionOffset offset = solved(TwoSides(3, [&](long row) {
      return 1 + range * static_cast<double>(row) / static_cast<double>(kSeamRows);
    }));
    EXPECT_FALSE(offset.phase) << range;
  }
}

TEST(PhaseSeams, ABorderThatAsksForTwoNumbersIsAmbiguous) {
  const RegionOffset offset = solved(TwoSides(3, [](long row) { return row < 40 ? 0.0 : 1.0; }));
  EXPECT_FALSE(offset.phase);
  EXPECT_EQ(offset.reason, Reason::ambiguous_offset);
}

TEST(PhaseSeams, AShortBorderProvesNothing) {
  TwoSides sides(3);
  sides.regions.label.topRows(45) = -1;
  EXPECT_FALSE(solved(sides).phase);
}

TEST(PhaseSeams, WhereRegionsTouchTheirCutProvesNothingUnlessAskedFor) {
  EXPECT_FALSE(solved(TwoSides(0)).phase);
  SeamLimits touching = kSeamLimits;
  touching.min_width = 0;
  EXPECT_EQ(solved(TwoSides(0), touching).phase, 8 * 2 * std::numbers::pi);
}

TEST(PhaseSeams, WorksAcrossRowsToo) {
  TwoSides sides(3);
  const Labels label = sides.regions.label.transpose();
  const Plane phase = sides.regions.phase.transpose();
  sides.regions.label = label;
  sides.regions.phase = phase;
  EXPECT_EQ(solved(sides).phase, 8 * 2 * std::numbers::pi);
}

TEST(PhaseSeams, SolvedRegionsSolveTheNextAndAmbiguousOnesStay) {
  TwoSides sides(3);
  sides.regions.label.rightCols(20) = 2;
  sides.regions.label.col(70) = -1;
  sides.regions.count = 3;
  sides.offsets.resize(3);
  auto offsets = sides.offsets;
  solve_from_neighbours(sides.regions, kSeamLimits, offsets);
  EXPECT_EQ(offsets[2].phase, 8 * 2 * std::numbers::pi);
  sides.offsets[1].reason = Reason::ambiguous_offset;
  solve_from_neighbours(sides.regions, kSeamLimits, sides.offsets);
  EXPECT_FALSE(sides.offsets[1].phase);
  EXPECT_EQ(sides.offsets[1].reason, Reason::ambiguous_offset);
  EXPECT_FALSE(sides.offsets[2].phase);
}

}  // namespace
}  // namespace palpate::sensing
