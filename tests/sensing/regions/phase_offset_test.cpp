// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/phase_offset.h"

#include <gtest/gtest.h>

#include <numbers>

namespace palpate::sensing {
namespace {

constexpr double kMinGuessAgreement = 0.7;

/// Region 0 left of column 10, region 1 from column 12 on; phase 0.5 everywhere.
Regions two_regions() {
  Regions regions{Labels::Constant(20, 20, -1), Plane::Constant(20, 20, 0.5F), 2};
  regions.label.leftCols(10) = 0;
  regions.label.rightCols(8) = 1;
  return regions;
}

/// Guesses for one column on consecutive rows, `turns` away from the unwrapped phase.
std::vector<PhaseGuess> column_of(int column, int first_row, int count, double turns,
                                  double score = 1) {
  std::vector<PhaseGuess> guesses;
  for (int i = 0; i < count; ++i)
    guesses.push_back({first_row + i, column, 0.5 + 2 * std::numbers::pi * turns, score, 3});
  return guesses;
}

std::vector<PhaseGuess> operator+(std::vector<PhaseGuess> a, const std::vector<PhaseGuess>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// The guesses come from `edges` stripe edges in turn.
std::vector<RegionOffset> offsets_of(const Regions& regions, std::vector<PhaseGuess> guesses,
                                     int edges = 2) {
  for (std::size_t i = 0; i < guesses.size(); ++i) guesses[i].edge = static_cast<int>(i) % edges;
  OffsetBuffers buffers;
  std::vector<RegionOffset> offsets(7);  // of another frame
  region_offsets(regions, guesses, kMinGuessAgreement, buffers, offsets);
  return offsets;
}

std::vector<Marker> markers_of(const Regions& regions, const std::vector<PhaseGuess>& guesses) {
  OffsetBuffers buffers;
  std::vector<Marker> markers(7);
  find_markers(regions, guesses, buffers, markers);
  return markers;
}

TEST(PhaseOffset, IsTheRoundedWeightedMedianOfEachRegion) {
  const auto guesses = column_of(3, 0, 8, -2.2) + column_of(5, 0, 1, 7.1) + column_of(5, 3, 2, -9) +
                       column_of(15, 0, 6, 4.3);
  const auto offsets = offsets_of(two_regions(), guesses);
  ASSERT_EQ(offsets.size(), 2U);
  EXPECT_DOUBLE_EQ(offsets[0].phase.value(), -2 * 2 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(offsets[1].phase.value(), 4 * 2 * std::numbers::pi);
}

TEST(PhaseOffset, WeightsDecideNotNumbers) {
  const auto guesses = column_of(3, 0, 6, 1, 2) + column_of(5, 0, 7, 5, 0.5);
  EXPECT_DOUBLE_EQ(offsets_of(two_regions(), guesses)[0].phase.value(), 2 * std::numbers::pi);
}

TEST(PhaseOffset, GuessesThatDisagreeOrAreFewGiveNone) {
  const auto guesses = column_of(3, 0, 6, 1) + column_of(5, 0, 5, 2) + column_of(15, 0, 4, 4);
  const auto offsets = offsets_of(two_regions(), guesses);
  EXPECT_FALSE(offsets[0].phase.has_value());
  EXPECT_FALSE(offsets[1].phase.has_value());
  EXPECT_EQ(offsets[0].reason, Reason::ambiguous_offset);
  EXPECT_EQ(offsets[1].reason, Reason::no_transition);
}

TEST(PhaseOffset, ASingleStripeEdgeMayHaveBeenMisreadAllAlong) {
  const auto guesses = column_of(3, 0, 18, 1.2);
  EXPECT_TRUE(offsets_of(two_regions(), guesses, 2)[0].phase);
  EXPECT_TRUE(offsets_of(two_regions(), column_of(3, 0, 18, 1.05), 1)[0].phase);
  const RegionOffset alone = offsets_of(two_regions(), guesses, 1)[0];
  EXPECT_FALSE(alone.phase);
  EXPECT_EQ(alone.reason, Reason::no_transition);
}

TEST(PhaseOffset, AFewGuessesOfAnotherEdgeProveNothing) {
  // One guess in twenty of another edge, on the same number of turns by chance.
  const auto guesses = column_of(3, 0, 20, 1.2);
  const auto offset = [&](int others) {
    std::vector<PhaseGuess> from = guesses;
    for (int i = 0; i < others; ++i) from[static_cast<std::size_t>(7 * i % 20)].edge = 4;
    OffsetBuffers buffers;
    std::vector<RegionOffset> offsets;
    region_offsets(two_regions(), from, kMinGuessAgreement, buffers, offsets);
    return offsets[0];
  };
  EXPECT_FALSE(offset(1).phase);
  EXPECT_TRUE(offset(5).phase);
}

TEST(PhaseOffset, GuessesOutsideEveryRegionDoNotCount) {
  EXPECT_FALSE(offsets_of(two_regions(), column_of(11, 0, 9, 1))[0].phase.has_value());
}

TEST(PhaseOffset, MarkersAreRunsOfGuessesThatConfirmEachOther) {
  const Regions regions = two_regions();
  EXPECT_EQ(markers_of(regions, column_of(3, 2, 6, -2.1)).size(), 6U);
  EXPECT_EQ(markers_of(regions, column_of(3, 2, 6, -2.1))[0].turns, -2);
  EXPECT_EQ(markers_of(regions, column_of(3, 2, 6, -2.1))[0].pixel, 2 * 20 + 3);
  EXPECT_TRUE(markers_of(regions, column_of(3, 2, 4, -2)).empty());    // too few
  EXPECT_TRUE(markers_of(regions, column_of(3, 2, 9, -2.4)).empty());  // between two numbers
  EXPECT_TRUE(markers_of(regions, column_of(3, 0, 4, 1) + column_of(3, 6, 4, 1)).empty());  // a gap
  EXPECT_TRUE(
      markers_of(regions, column_of(2, 0, 4, 1) + column_of(8, 4, 4, 1)).empty());  // a jump
  EXPECT_TRUE(markers_of(regions, column_of(3, 0, 4, 1) + column_of(3, 4, 4, 2)).empty());
}

TEST(PhaseOffset, AnAnchorGivesItsRegionAnOffsetAndNoOther) {
  PhaseGuess anchor{.row = 4, .column = 3, .phase = 0.7 + 3 * 2 * std::numbers::pi, .score = 1};
  std::vector<RegionOffset> offsets;
  anchored_offsets(two_regions(), {anchor}, offsets);
  EXPECT_DOUBLE_EQ(offsets[0].phase.value(), 3 * 2 * std::numbers::pi);
  EXPECT_EQ(offsets[1].reason, Reason::no_transition);
  PhaseGuess other = anchor;
  other.column = 12;
  anchored_offsets(two_regions(), {anchor, other, anchor}, offsets);
  EXPECT_TRUE(offsets[0].phase && offsets[1].phase);
  other.column = 4;
  other.phase += 2 * std::numbers::pi;
  anchored_offsets(two_regions(), {anchor, other, anchor}, offsets);
  EXPECT_EQ(offsets[0].reason, Reason::ambiguous_offset);
}

TEST(PhaseOffset, AnchorsOfOneSurfaceContradictEachOtherIfPeriodsAreBetweenThem) {
  const Regions regions = two_regions();
  const PhaseGuess anchor{.row = 4, .column = 3, .phase = 0.7, .score = 1, .edge = 5};
  PhaseGuess other = anchor;
  other.column = 4;
  other.phase -= 2 * 2 * std::numbers::pi;
  other.edge = 6;
  PhaseGuess elsewhere = other;
  elsewhere.column = 12;
  EXPECT_FALSE(contradicting_anchors(regions, {anchor, elsewhere, anchor}));
  const auto pair = contradicting_anchors(regions, {elsewhere, anchor, other});
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->first.edge, 5);
  EXPECT_EQ(pair->second.edge, 6);
  EXPECT_EQ(pair->periods, 2);
  PhaseGuess outside = other;
  outside.column = 11;
  EXPECT_FALSE(contradicting_anchors(regions, {anchor, outside}));
}

TEST(PhaseOffset, AnAnchorOutsideEveryRegionSaysNothing) {
  const PhaseGuess outside{.row = 4, .column = 11, .phase = 0.7, .score = 1};
  std::vector<RegionOffset> offsets;
  anchored_offsets(two_regions(), {outside}, offsets);
  for (const RegionOffset& offset : offsets) EXPECT_FALSE(offset.phase);
}

TEST(PhaseOffset, AnAnchorBesideRegionsMovesToTheNearestPixelOfOne) {
  const PhaseGuess beside{.row = 4, .column = 11, .phase = 0, .score = 1};
  EXPECT_EQ(nearest_in_region(two_regions(), beside, 2)->column, 12);  // 9 is farther
  EXPECT_FALSE(nearest_in_region(two_regions(), beside, 0));
}

}  // namespace
}  // namespace palpate::sensing
