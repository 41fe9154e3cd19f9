// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase_variance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hue.h"

namespace palpate::sensing {
namespace {

/// Sums of nine squares of floats near 1.
constexpr double kRounding = 1e-5;

Plane ramp(long rows, long columns, double down, double across) {
  Plane phase(rows, columns);
  for (long row = 0; row < rows; ++row) {
    for (long column = 0; column < columns; ++column) {
      phase(row, column) = static_cast<float>(
          wrap(down * static_cast<double>(row) + across * static_cast<double>(column)));
    }
  }
  return phase;
}

TEST(PhaseVariance, ASlopeHasNoneAcrossWrapsAndAtBorders) {
  const Plane variance = phase_variance(ramp(12, 15, 0.9, -0.4), Mask::Ones(12, 15));
  EXPECT_LT(variance.maxCoeff(), kRounding);
}

TEST(PhaseVariance, AStepHasTheVarianceOfOneDifferenceAmongNine) {
  Plane phase = ramp(12, 15, 0.2, 0);
  phase.rightCols(7) += 0.6F;  // between columns 7 and 8
  const Plane variance = phase_variance(phase, Mask::Ones(12, 15));
  // Three of nine differences to the right are 0.6: variance 0.36 (1/3 - 1/9).
  EXPECT_NEAR(variance(5, 7), 0.36 * 2 / 9, kRounding);
  EXPECT_NEAR(variance(5, 6), 0.36 * 2 / 9, kRounding);
  EXPECT_NEAR(variance(5, 8), 0.36 * 2 / 9, kRounding);
  EXPECT_NEAR(variance(5, 4), 0, kRounding);
  EXPECT_NEAR(variance(5, 10), 0, kRounding);
}

TEST(PhaseVariance, WhatLiesOutsideTheMaskDoesNotCount) {
  Plane phase = ramp(12, 15, 0.2, 0.1);
  phase.leftCols(5) = 2;
  phase(6, 2) = std::nanf("");
  Mask mask = Mask::Ones(12, 15);
  mask.leftCols(5) = 0;
  const Plane variance = phase_variance(phase, mask);
  EXPECT_LT(variance.rightCols(10).maxCoeff(), kRounding);
  EXPECT_TRUE(std::isinf(variance(6, 4)));
}

TEST(PhaseVariance, IsUnknownInAnImageWithoutThreeRowsOrColumns) {
  EXPECT_TRUE(phase_variance(ramp(2, 15, 0.2, 0.1), Mask::Ones(2, 15)).isInf().all());
  EXPECT_TRUE(phase_variance(ramp(12, 2, 0.2, 0.1), Mask::Ones(12, 2)).isInf().all());
}

}  // namespace
}  // namespace palpate::sensing
