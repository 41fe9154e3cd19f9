// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "unwrapping.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "hue.h"
#include "phase_variance.h"

namespace palpate::sensing {
namespace {

constexpr FloodLimits kLimits{.max_variance = 0.05, .max_step = 1.5};
constexpr float kTurn = 2 * std::numbers::pi_v<float>;
/// A path of 100 additions of floats near 30.
constexpr double kRounding = 1e-3;

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

TEST(Unwrapping, GivesASmoothSurfaceBackUpToWholeTurns) {
  const Plane phase = hill(40, 50);
  const Plane wrapped_phase = wrapped(phase);
  const Plane variance = phase_variance(wrapped_phase, Mask::Ones(40, 50));
  const Regions regions = grow_regions(wrapped_phase, variance, {.max_variance = 1, .max_step = 3});
  ASSERT_EQ(regions.count, 1);
  const Plane offset = (regions.phase - phase) / kTurn;
  EXPECT_NEAR(offset.maxCoeff(), offset.minCoeff(), kRounding);
  EXPECT_NEAR(offset(0, 0), std::round(offset(0, 0)), kRounding);
}

TEST(Unwrapping, RegionsEndWhereThePhaseIsNotSmooth) {
  Plane phase = Plane::Zero(30, 40);
  phase.rightCols(20) = 2.5F;
  const Plane variance = phase_variance(phase, Mask::Ones(30, 40));
  const Regions regions = grow_regions(phase, variance, kLimits);
  EXPECT_EQ(regions.count, 2);
  EXPECT_NE(regions.label(10, 5), regions.label(10, 35));
  EXPECT_EQ(regions.label(10, 5), regions.label(29, 0));
  EXPECT_EQ(regions.label(10, 19), -1);
}

TEST(Unwrapping, StepsOfMoreThanTheLimitAreNotCrossed) {
  Plane phase = Plane::Zero(6, 6);
  phase.rightCols(3) = 2.5F;
  const Regions regions = grow_regions(phase, Plane::Zero(6, 6), kLimits);
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
  Regions regions = grow_regions(step.wrapped, step.variance, kLimits);
  ASSERT_EQ(regions.count, 1);
  const std::vector<Marker> markers = {{40 * 15 + 3, 0}, {40 * 15 + 27, 1}};
  split_regions(step.wrapped, step.variance, kLimits, markers, regions);
  EXPECT_EQ(regions.count, 2);
  for (long row = 0; row < 30; ++row) {
    EXPECT_EQ(regions.label(row, 18), regions.label(15, 3)) << row;
    EXPECT_EQ(regions.label(row, 21), regions.label(15, 27)) << row;
  }
  EXPECT_NE(regions.label(15, 3), regions.label(15, 27));
}

TEST(Unwrapping, AgreeingMarkersLeaveARegionWhole) {
  const HiddenStep step;
  Regions regions = grow_regions(step.wrapped, step.variance, kLimits);
  split_regions(step.wrapped, step.variance, kLimits, {{5, 2}, {40 * 20 + 35, 2}}, regions);
  EXPECT_EQ(regions.count, 1);
  EXPECT_TRUE((regions.label == 0).all());
}

TEST(Unwrapping, WhatHangsOnByANarrowNeckNeedsAMarkerOfItsOwn) {
  const Plane wrapped_phase = Plane::Zero(40, 80);
  const Marker left{40 / 2 * 80 + 10, 3};
  const Marker right{40 / 2 * 80 + 70, 4};
  for (const long neck : {5L, 9L}) {
    // Two squares of 30 pixels, joined by a neck.
    Plane variance = Plane::Constant(40, 80, std::numeric_limits<float>::infinity());
    variance.block(5, 5, 30, 30) = 0;
    variance.block(5, 45, 30, 30) = 0;
    variance.block(20 - neck / 2, 35, neck, 10) = 0;
    Regions regions = grow_regions(wrapped_phase, variance, kLimits);
    ASSERT_EQ(regions.count, 1);
    EXPECT_TRUE(mark_unproven_cores(wrapped_phase, variance, kLimits, {left, right}).empty());
    std::vector<Marker> markers = mark_unproven_cores(wrapped_phase, variance, kLimits, {left});
    EXPECT_EQ(markers.empty(), neck == 9);
    markers.push_back(left);
    split_regions(wrapped_phase, variance, kLimits, markers, regions);
    EXPECT_EQ(regions.label(20, 10) == regions.label(20, 70), neck == 9);
  }
}

TEST(Unwrapping, ASmallPatchMayLieBetweenTwoStripeEdges) {
  const Plane wrapped_phase = Plane::Zero(40, 40);
  Plane variance = Plane::Constant(40, 40, std::numeric_limits<float>::infinity());
  variance.block(5, 5, 20, 20) = 0;  // 14 x 14 pixels are left of it
  EXPECT_TRUE(mark_unproven_cores(wrapped_phase, variance, kLimits, {}).empty());
  variance.block(5, 5, 30, 30) = 0;
  EXPECT_EQ(mark_unproven_cores(wrapped_phase, variance, kLimits, {}).size(), 24U * 24U);
}

}  // namespace
}  // namespace palpate::sensing
