// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/surface_pieces.h"

#include <gtest/gtest.h>

#include <limits>

#include "regions/unwrapping.h"

namespace palpate::sensing {
namespace {

constexpr long kPieceRows = 90, kPieceColumns = 70, kSeam = 23, kTile = 5;

/// A surface, or two that meet at a column, whose border leaves a doubt except on some rows.
SurfaceDoubt doubt_at_seam(long first_sure, long sure_rows, float seam) {
  SurfaceDoubt doubt{.down = Plane::Constant(kPieceRows, kPieceColumns, 0.1F), .across = {}};
  doubt.across = doubt.down;
  doubt.across.col(kSeam) = seam;
  doubt.across.col(kSeam).segment(first_sure, sure_rows) = 0.1F;
  return doubt;
}

/// Returns true if both sides of the seam are in one region.
bool is_one(const SurfaceDoubt& doubt, bool transposed = false) {
  Plane variance = Plane::Zero(kPieceRows, kPieceColumns);
  SurfaceDoubt seen = doubt;
  if (transposed) {
    variance = Plane::Zero(kPieceColumns, kPieceRows);
    seen.down = doubt.across.transpose();
    seen.across = doubt.down.transpose();
  }
  cut_into_pieces(seen, kTile, 300, variance);
  EXPECT_GE((variance == 0).count(), 0.9 * static_cast<double>(variance.size()));
  UnwrappingBuffers buffers;
  Regions regions;
  grow_regions(Plane::Zero(variance.rows(), variance.cols()), variance,
               {.max_variance = 1, .max_step = 1}, buffers, regions);
  const long row = kPieceRows / 2, left = kSeam - 8, right = kSeam + 12;
  return transposed ? regions.label(left, row) == regions.label(right, row)
                    : regions.label(row, left) == regions.label(row, right);
}

// Along a step, the fraction of a turn between the phases of its sides changes. If it is close to
// zero, there is no doubt.
TEST(SurfacePieces, AreNotJoinedByTheNeckWhereTheirPhasesAgree) {
  for (const double agreeing : {30.0, 52.0}) {
    SurfaceDoubt doubt = doubt_at_seam(0, 0, 0);
    for (long row = 0; row < kPieceRows; ++row) {
      const double turns = (static_cast<double>(row) - agreeing) / 70;
      doubt.across(row, kSeam) = 0.1F + static_cast<float>(turns * turns / (0.15 * 0.15));
    }
    for (const bool transposed : {false, true}) EXPECT_FALSE(is_one(doubt, transposed)) << agreeing;
  }
}

TEST(SurfacePieces, StayWholeAroundADoubtfulFold) {
  for (const bool transposed : {false, true}) {
    EXPECT_TRUE(is_one(doubt_at_seam(0, kPieceRows, 3), transposed));
    EXPECT_FALSE(is_one(doubt_at_seam(0, 0, 3), transposed));
    EXPECT_TRUE(is_one(doubt_at_seam(0, 65, 3), transposed));
    EXPECT_TRUE(is_one(doubt_at_seam(0, 0, 0.8F), transposed));
  }
}

// Around a hole, nothing speaks for one surface or against it.
TEST(SurfacePieces, AreNotJoinedAcrossUnknownPixels) {
  SurfaceDoubt doubt = doubt_at_seam(0, 0, std::numeric_limits<float>::infinity());
  doubt.down.col(kSeam) = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(is_one(doubt));
}

TEST(SurfacePieces, LoseWhatIsTooSmall) {
  SurfaceDoubt doubt = doubt_at_seam(0, 0, 3);
  Plane variance = Plane::Zero(kPieceRows, kPieceColumns);
  const long narrower = kPieceRows * (kSeam + kTile);  // the seam is within a tile
  cut_into_pieces(doubt, kTile, narrower, variance);
  EXPECT_TRUE(variance.leftCols(kSeam - kTile).isInf().all());
  EXPECT_EQ(variance(kPieceRows / 2, kPieceColumns - 8), 0.0F);
}

TEST(SurfacePieces, TakeImagesThatAreNoMultipleOfTheTile) {
  for (const long size : {1L, 4L, 5L, 6L, 11L}) {
    Plane variance = Plane::Zero(size, 12 - size);
    const Plane none = variance;
    cut_into_pieces({.down = none, .across = none}, kTile, 1, variance);
    EXPECT_TRUE((variance == 0).all()) << size;
  }
}

}  // namespace
}  // namespace palpate::sensing
