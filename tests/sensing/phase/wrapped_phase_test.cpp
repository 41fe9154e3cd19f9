// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/wrapped_phase.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "image/hue.h"
#include "phase/phase_testing.h"

namespace palpate::sensing {
namespace {

float angle_of(float re, float im) {
  Plane wrapped;
  find_wrapped_phase(Plane::Constant(1, 1, re), Plane::Constant(1, 1, im), wrapped);
  return wrapped(0, 0);
}

TEST(WrappedPhase, IsTheArcTangentAllAroundTheCircle) {
  constexpr double kBound = 4e-7;
  constexpr int kAngles = 100003;
  Plane re(1, kAngles);
  Plane im(1, kAngles);
  for (int i = 0; i < kAngles; ++i) {
    const double angle = 2 * std::numbers::pi * i / kAngles;
    const double length = std::pow(10.0, i % 13 - 6);
    re(0, i) = static_cast<float>(length * std::cos(angle));
    im(0, i) = static_cast<float>(length * std::sin(angle));
  }
  Plane wrapped;
  find_wrapped_phase(re, im, wrapped);
  for (int i = 0; i < kAngles; ++i) {
    const double exact = std::atan2(static_cast<double>(im(0, i)), static_cast<double>(re(0, i)));
    ASSERT_NEAR(static_cast<double>(wrapped(0, i)), exact, kBound) << re(0, i) << ' ' << im(0, i);
  }
}

TEST(WrappedPhase, OfTheAxesAndOfNothing) {
  constexpr float kPi = std::numbers::pi_v<float>;
  EXPECT_FLOAT_EQ(angle_of(2, 0), 0);
  EXPECT_FLOAT_EQ(angle_of(0, 3), kPi / 2);
  EXPECT_FLOAT_EQ(angle_of(0, -3), -kPi / 2);
  EXPECT_FLOAT_EQ(angle_of(-1, 0), kPi);
  EXPECT_EQ(angle_of(0, 0), 0);
  EXPECT_TRUE(std::isnan(angle_of(std::numeric_limits<float>::quiet_NaN(), 1)));
}

/// Sums of nine squares of floats near 1.
constexpr double kVarianceRounding = 1e-5;

Plane wrapped_ramp(long rows, long columns, double down, double across) {
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
  const Plane variance = variance_of(wrapped_ramp(12, 15, 0.9, -0.4), Mask::Ones(12, 15));
  EXPECT_LT(variance.maxCoeff(), kVarianceRounding);
}

TEST(PhaseVariance, AStepHasTheVarianceOfOneDifferenceAmongNine) {
  Plane phase = wrapped_ramp(12, 15, 0.2, 0);
  phase.rightCols(7) += 0.6F;  // between columns 7 and 8
  const Plane variance = variance_of(phase, Mask::Ones(12, 15));
  // Three of nine differences to the right are 0.6: variance 0.36 (1/3 - 1/9).
  EXPECT_NEAR(variance(5, 7), 0.36 * 2 / 9, kVarianceRounding);
  EXPECT_NEAR(variance(5, 6), 0.36 * 2 / 9, kVarianceRounding);
  EXPECT_NEAR(variance(5, 8), 0.36 * 2 / 9, kVarianceRounding);
  EXPECT_NEAR(variance(5, 4), 0, kVarianceRounding);
  EXPECT_NEAR(variance(5, 10), 0, kVarianceRounding);
}

TEST(PhaseVariance, WhatLiesOutsideTheMaskDoesNotCount) {
  Plane phase = wrapped_ramp(12, 15, 0.2, 0.1);
  phase.leftCols(5) = 2;
  phase(6, 2) = std::nanf("");
  Mask mask = Mask::Ones(12, 15);
  mask.leftCols(5) = 0;
  const Plane variance = variance_of(phase, mask);
  EXPECT_LT(variance.rightCols(10).maxCoeff(), kVarianceRounding);
  EXPECT_TRUE(std::isinf(variance(6, 4)));
}

TEST(PhaseVariance, IsUnknownInAnImageWithoutThreeRowsOrColumns) {
  EXPECT_TRUE(variance_of(wrapped_ramp(2, 15, 0.2, 0.1), Mask::Ones(2, 15)).isInf().all());
  EXPECT_TRUE(variance_of(wrapped_ramp(12, 2, 0.2, 0.1), Mask::Ones(12, 2)).isInf().all());
}

/// Row after row, pixel after pixel, from the definition.
Plane slow_variance(const Plane& wrapped, const Mask& mask) {
  Plane result = Plane::Constant(wrapped.rows(), wrapped.cols(), INFINITY);
  for (long row = 0; row < wrapped.rows(); ++row) {
    for (long column = 0; column < wrapped.cols(); ++column) {
      if (mask(row, column) == 0) continue;
      result(row, column) = 0;
      for (const long down : {0L, 1L}) {
        std::vector<double> steps;
        for (long r = std::max(0L, row - 1); r <= std::min(row + 1, wrapped.rows() - 1); ++r) {
          for (long c = std::max(0L, column - 1); c <= std::min(column + 1, wrapped.cols() - 1);
               ++c) {
            const long other_r = r + down;
            const long other_c = c + 1 - down;
            if (other_r >= wrapped.rows() || other_c >= wrapped.cols()) continue;
            if (mask(r, c) == 0 || mask(other_r, other_c) == 0) continue;
            steps.push_back(static_cast<double>(wrap(wrapped(other_r, other_c) - wrapped(r, c))));
          }
        }
        const Eigen::Map<Eigen::ArrayXd> all(steps.data(), static_cast<long>(steps.size()));
        if (!steps.empty()) {
          result(row, column) += static_cast<float>((all - all.mean()).square().mean());
        }
      }
    }
  }
  return result;
}

TEST(PhaseVariance, IsWhatItsDefinitionSaysOnAnyPhaseAndMask) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> phase(-3.14F, 3.14F);
  std::bernoulli_distribution inside(0.8);
  Plane variance;
  for (const auto& [rows, columns] : {std::pair{3, 3}, {17, 23}, {8, 64}, {30, 5}}) {
    const Plane wrapped =
        Plane::NullaryExpr(rows, columns, [&](long, long) { return phase(random); });
    const Mask mask = Mask::NullaryExpr(
        rows, columns, [&](long, long) { return static_cast<std::uint8_t>(inside(random)); });
    phase_variance(wrapped, mask, variance);  // into an image that had another size
    const Plane expected = slow_variance(wrapped, mask);
    for (long i = 0; i < expected.size(); ++i) {
      if (std::isinf(expected.data()[i])) {
        EXPECT_TRUE(std::isinf(variance.data()[i])) << i;
      } else {
        EXPECT_NEAR(variance.data()[i], expected.data()[i], 10 * kVarianceRounding) << i;
      }
    }
  }
}

}  // namespace
}  // namespace palpate::sensing
