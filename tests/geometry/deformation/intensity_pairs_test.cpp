// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "deformation/intensity_pairs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

namespace palpate::geometry {
namespace {

using Eigen::Vector2d;

TEST(IntensityNoise, IsCorrelatedAsWhiteNoiseThatAGaussianBlurs) {
  constexpr int kSide = 300;
  std::vector<Vector2d> pixels;
  for (int row = 0; row < kSide; ++row)
    for (int col = 0; col < kSide; ++col) pixels.emplace_back(col + 20, row + 40);
  std::mt19937_64 random(1);
  const std::vector<double> errors = intensity_noise(pixels, random);

  // Of about kSide² / (4 pi) independent errors, a correlation has a deviation of 0.012.
  constexpr double kTolerance = 0.05;
  for (const int distance : {0, 1, 2, 3, 6}) {
    double product = 0;
    long count = 0;
    for (int row = 0; row < kSide; ++row) {
      for (int col = distance; col < kSide; ++col, ++count) {
        const auto at = static_cast<std::size_t>(row * kSide + col);
        product += errors[at] * errors[at - static_cast<std::size_t>(distance)];
      }
    }
    // The least blur has a deviation of one pixel.
    EXPECT_NEAR(product / static_cast<double>(count), std::exp(-distance * distance / 4.0),
                kTolerance)
        << distance;
  }
}

TEST(IntensityNoise, IsZeroWhereNoPixelIsKnown) {
  const Vector2d unknown = Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  std::mt19937_64 random(1);
  const std::vector<double> errors =
      intensity_noise(std::vector<Vector2d>{unknown, Vector2d(7.5, 3.25), unknown}, random);
  EXPECT_EQ(errors[0], 0);
  EXPECT_NEAR(std::abs(errors[1]), 1, 1e-12);
  EXPECT_EQ(errors[2], 0);
  EXPECT_EQ(intensity_noise(std::vector<Vector2d>{unknown}, random), std::vector<double>{0});
}

}  // namespace
}  // namespace palpate::geometry
