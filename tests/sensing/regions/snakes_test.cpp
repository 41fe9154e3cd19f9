// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/snakes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "image/hue.h"
#include "phase/phase_testing.h"

namespace palpate::sensing {
namespace {

constexpr FloodLimits kSnakeLimits{.max_variance = 0.01, .max_step = 1.5};

Regions snakes_of(const Plane& wrapped, const Mask& mask) {
  Regions regions;
  grow_snakes(wrapped, variance_of(wrapped, mask), kSnakeLimits, regions);
  return regions;
}

/// A ramp of several turns with a step of the phase along a column, except for
/// a gap.
Plane stepped(double step, long gap) {
  Plane wrapped(90, 140);
  for (long row = 0; row < 90; ++row) {
    for (long column = 0; column < 140; ++column) {
      const bool behind = column >= 70 && std::abs(row - 45) > gap / 2;
      const bool flows = std::abs(row - 45) <= gap / 2;
      // In the gap the step is stretched into a slope as gentle as any.
      const double share = flows ? std::clamp((static_cast<double>(column) - 55) / 30, 0.0, 1.0)
                                 : (behind ? 1.0 : 0.0);
      wrapped(row, column) = static_cast<float>(wrap(
          0.21 * static_cast<double>(row) - 0.13 * static_cast<double>(column) + step * share));
    }
  }
  return wrapped;
}

TEST(Snakes, FindAndUnwrapASmoothSurface) {
  const Plane wrapped = stepped(0, 0);
  const Regions regions = snakes_of(wrapped, Mask::Ones(90, 140));
  EXPECT_GT((regions.label == 0).count(), 0.99 * 90 * 140);
  for (long row = 1; row < 90; ++row) {
    for (long column = 1; column < 140; ++column) {
      if (regions.label(row, column) != 0 || regions.label(row - 1, column - 1) != 0) continue;
      ASSERT_NEAR(regions.phase(row, column) - regions.phase(row - 1, column - 1), 0.08, 1e-3);
    }
  }
}

TEST(Snakes, BridgeAGapInABorderThatAFloodFlowsThrough) {
  const Plane wrapped = stepped(2.5, 6);
  const Mask mask = Mask::Ones(90, 140);
  UnwrappingBuffers buffers;
  Regions flooded;
  grow_regions(wrapped, variance_of(wrapped), kSnakeLimits, buffers, flooded);
  ASSERT_EQ(flooded.label(10, 10), flooded.label(10, 130));
  const Regions regions = snakes_of(wrapped, mask);
  EXPECT_NE(regions.label(10, 10), regions.label(10, 130));
  EXPECT_EQ(regions.label(10, 10), regions.label(80, 10));
  EXPECT_EQ(regions.label(10, 130), regions.label(80, 130));
}

TEST(Snakes, FillWhatTheMaskLeavesAndNoMore) {
  // A C, whose arms are wide enough for a circle.
  Mask mask = Mask::Zero(100, 100);
  mask.block(10, 10, 80, 80) = 1;
  mask.block(35, 40, 30, 60) = 0;
  Plane wrapped = Plane::Constant(100, 100, std::numeric_limits<float>::quiet_NaN());
  wrapped = (mask != 0).select(Plane::Zero(100, 100), wrapped);
  const Regions regions = snakes_of(wrapped, mask);
  EXPECT_EQ((regions.label >= 0 && mask == 0).count(), 0);
  EXPECT_GT(static_cast<double>((regions.label >= 0).count()),
            0.95 * static_cast<double>((mask != 0).count()));
  EXPECT_EQ(regions.label(20, 80), regions.label(80, 80));
}

TEST(Snakes, GiveEachPixelToOneRegionAndTheSameEveryTime) {
  Plane wrapped = stepped(2.5, 0);
  Mask mask = Mask::Ones(90, 140);
  mask.row(30) = 0;
  const Regions once = snakes_of(wrapped, mask);
  const Regions again = snakes_of(wrapped, mask);
  EXPECT_EQ(once.count, again.count);
  EXPECT_TRUE((once.label == again.label).all());
  EXPECT_GE(once.count, 4);
  EXPECT_LT(once.label.maxCoeff(), once.count);
}

TEST(Snakes, FindNothingInNoiseOrInTheDarkOrWhereNoCircleFits) {
  EXPECT_EQ(snakes_of(Plane::Zero(40, 40), Mask::Zero(40, 40)).count, 0);
  EXPECT_EQ(snakes_of(Plane::Zero(2, 40), Mask::Ones(2, 40)).count, 0);
  EXPECT_EQ(snakes_of(Plane::Zero(12, 60), Mask::Ones(12, 60)).count, 0);
  Plane noise(60, 60);
  unsigned state = 1;
  for (long i = 0; i < noise.size(); ++i) {
    state = 1664525 * state + 1013904223;
    noise.data()[i] = wrap(static_cast<float>(state >> 8) * 1e-3F);
  }
  EXPECT_EQ(snakes_of(noise, Mask::Ones(60, 60)).count, 0);
}

TEST(Snakes, LeaveOutRoughPixelsButPassThem) {
  Plane wrapped = stepped(0, 0);
  wrapped(45, 70) += 2;
  const Regions regions = snakes_of(wrapped, Mask::Ones(90, 140));
  EXPECT_EQ(regions.label(45, 70), -1);
  EXPECT_EQ(regions.label(45, 60), regions.label(45, 80));
  const float across = regions.phase(45, 80) - regions.phase(45, 60);
  EXPECT_NEAR(across, -0.13F * 20, 1e-3);
  EXPECT_LT(std::abs(across), 2 * std::numbers::pi_v<float>);
}

}  // namespace
}  // namespace palpate::sensing
