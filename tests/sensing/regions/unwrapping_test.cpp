// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/unwrapping.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "image/hue.h"
#include "phase/phase_testing.h"

namespace palpate::sensing {
namespace {

constexpr FloodLimits kFloodLimits{.max_variance = 0.05, .max_step = 1.5};
/// A path of 100 additions of floats near 30.
constexpr double kPathRounding = 1e-3;

/// A hill many turns high.
Plane hill(long rows, long columns) {
  Plane phase(rows, columns);
  for (long row = 0; row < rows; ++row) {
    for (long column = 0; column < columns; ++column) {
      const double x = (static_cast<double>(column) - 20) / 15;
      const double y = (static_cast<double>(row) - 15) / 12;
      phase(row, column) = static_cast<float>(30 * std::exp(-x * x - y * y));
    }
  }
  return phase;
}

Plane wrapped(const Plane& phase) {
  return phase.unaryExpr([](float value) { return wrap(value); });
}

Regions grown(const Plane& wrapped, const Plane& variance,
              const FloodLimits& limits = kFloodLimits) {
  UnwrappingBuffers buffers;
  Regions regions;
  grow_regions(wrapped, variance, limits, buffers, regions);
  return regions;
}

void split(const Plane& wrapped, const Plane& variance, const std::vector<Marker>& markers,
           Regions& regions) {
  UnwrappingBuffers buffers;
  split_regions(wrapped, variance, kFloodLimits, markers, buffers, regions);
}

TEST(Unwrapping, GivesASmoothSurfaceBackUpToWholeTurns) {
  const Plane phase = hill(40, 50);
  const Plane wrapped_phase = wrapped(phase);
  const Plane variance = variance_of(wrapped_phase);
  const Regions regions = grown(wrapped_phase, variance, {.max_variance = 1, .max_step = 3});
  ASSERT_EQ(regions.count, 1);
  const Plane offset = (regions.phase - phase) / (2 * std::numbers::pi_v<float>);
  EXPECT_NEAR(offset.maxCoeff(), offset.minCoeff(), kPathRounding);
  EXPECT_NEAR(offset(0, 0), std::round(offset(0, 0)), kPathRounding);
}

TEST(Unwrapping, RegionsEndWhereThePhaseIsNotSmooth) {
  Plane phase = Plane::Zero(30, 40);
  phase.rightCols(20) = 2.5F;
  const Plane variance = variance_of(phase);
  const Regions regions = grown(phase, variance);
  EXPECT_EQ(regions.count, 2);
  EXPECT_NE(regions.label(10, 5), regions.label(10, 35));
  EXPECT_EQ(regions.label(10, 5), regions.label(29, 0));
  EXPECT_EQ(regions.label(10, 19), -1);
}

TEST(Unwrapping, StepsOfMoreThanTheLimitAreNotCrossed) {
  Plane phase = Plane::Zero(6, 6);
  phase.rightCols(3) = 2.5F;
  const Regions regions = grown(phase, Plane::Zero(6, 6));
  EXPECT_EQ(regions.count, 2);
}

/// Two flat surfaces, a whole turn apart: the wrapped phase is zero everywhere; only a little
/// variance shows where they meet.
struct HiddenStep {
  Plane wrapped = Plane::Zero(30, 40);
  Plane variance = Plane::Constant(30, 40, 1e-3F);
  HiddenStep() { variance.middleCols(19, 2) = 0.02F; }
};

TEST(Unwrapping, DisagreeingMarkersSplitARegionWhereItIsLeastSmooth) {
  const HiddenStep step;
  Regions regions = grown(step.wrapped, step.variance);
  ASSERT_EQ(regions.count, 1);
  const std::vector<Marker> markers = {{40 * 15 + 3, 0}, {40 * 15 + 27, 1}};
  split(step.wrapped, step.variance, markers, regions);
  EXPECT_EQ(regions.count, 2);
  for (long row = 0; row < 30; ++row) {
    EXPECT_EQ(regions.label(row, 18), regions.label(15, 3)) << row;
    EXPECT_EQ(regions.label(row, 21), regions.label(15, 27)) << row;
  }
  EXPECT_NE(regions.label(15, 3), regions.label(15, 27));
}

TEST(Unwrapping, AgreeingMarkersLeaveARegionWhole) {
  const HiddenStep step;
  Regions regions = grown(step.wrapped, step.variance);
  split(step.wrapped, step.variance, {{5, 2}, {40 * 20 + 35, 2}}, regions);
  EXPECT_EQ(regions.count, 1);
  EXPECT_TRUE((regions.label == 0).all());
}

TEST(Unwrapping, WhatHangsOnByANarrowNeckNeedsAMarkerOfItsOwn) {
  const Plane wrapped_phase = Plane::Zero(40, 80);
  const Marker left{40 / 2 * 80 + 10, 3};
  const Marker right{40 / 2 * 80 + 70, 3};
  for (const long neck : {5L, 9L}) {
    // Two squares of 30 pixels, joined by a neck.
    Plane variance = Plane::Constant(40, 80, std::numeric_limits<float>::infinity());
    variance.block(5, 5, 30, 30) = 0;
    variance.block(5, 45, 30, 30) = 0;
    variance.block(20 - neck / 2, 35, neck, 10) = 0;
    Regions regions = grown(wrapped_phase, variance);
    ASSERT_EQ(regions.count, 1);
    split(wrapped_phase, variance, {left, right}, regions);
    EXPECT_EQ(regions.count, 1);
    split(wrapped_phase, variance, {left}, regions);
    EXPECT_EQ(regions.count, neck == 9 ? 1 : 2);
    EXPECT_EQ(regions.label(20, 10) == regions.label(20, 70), neck == 9);
    EXPECT_EQ(regions.label(5, 5), regions.label(20, 10));
  }
}

TEST(Unwrapping, PixelsInNoRegionStaySoWhateverTheLimitsOfTheSplit) {
  // Around the region are pixels of which the split, but not the growth, would make a core.
  const Plane wrapped_phase = Plane::Zero(60, 80);
  Plane variance = Plane::Constant(60, 80, 0.04F);
  variance.block(20, 20, 10, 10) = 0;
  Regions regions = grown(wrapped_phase, variance, {.max_variance = 0.01, .max_step = 1.5});
  const Labels before = regions.label;
  ASSERT_EQ(regions.count, 1);
  split(wrapped_phase, variance, {{80 * 25 + 25, 1}, {0, 3}}, regions);
  EXPECT_EQ(regions.count, 1);
  EXPECT_TRUE((regions.label == before).all());
}

TEST(Unwrapping, ASmallPatchMayLieBetweenTwoStripeEdges) {
  const Plane wrapped_phase = Plane::Zero(40, 80);
  const Marker marker{40 / 2 * 80 + 10, 3};
  for (const long side : {20L, 30L}) {  // 14 x 14 pixels are left of the small one
    Plane variance = Plane::Constant(40, 80, std::numeric_limits<float>::infinity());
    variance.block(5, 5, 30, 30) = 0;
    variance.block(5, 45, side, side) = 0;
    variance.block(15, 35, 3, 10) = 0;
    Regions regions = grown(wrapped_phase, variance);
    split(wrapped_phase, variance, {marker}, regions);
    EXPECT_EQ(regions.count, side == 20 ? 1 : 2);
  }
}

TEST(Unwrapping, ACoreWhoseMarkersDisagreeIsCutWhereItIsLeastSmooth) {
  // The whole image is one core; a ridge well below the limit crosses it at column 30.
  const Plane wrapped_phase = Plane::Zero(40, 80);
  Plane variance = Plane::Constant(40, 80, 1e-3F);
  variance.col(30) = 0.03F;
  Regions regions = grown(wrapped_phase, variance);
  split(wrapped_phase, variance, {{5, 0}, {40 * 80 - 5, 1}, {35, 1}}, regions);
  EXPECT_EQ(regions.count, 2);
  EXPECT_TRUE((regions.label.leftCols(30) == regions.label(0, 0)).all());
  EXPECT_TRUE((regions.label.rightCols(49) == regions.label(0, 79)).all());
  EXPECT_NE(regions.label(0, 0), regions.label(0, 79));
}

}  // namespace
}  // namespace palpate::sensing
