// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/phase_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "phase/phase_testing.h"

namespace palpate::sensing {
namespace {

constexpr long kNoisyRows = 240;
constexpr long kNoisyColumns = 320;

/// mean + amplitude cos(carrier row + phase), normal noise of variance `read` + `shot` * value.
Plane noisy_wave(double mean, double amplitude, double read, double shot, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  Plane image(kNoisyRows, kNoisyColumns);
  for (long row = 0; row < kNoisyRows; ++row) {
    const double value = mean + amplitude * std::cos(kCarrier * static_cast<double>(row) + kPhase);
    for (long column = 0; column < kNoisyColumns; ++column) {
      image(row, column) =
          static_cast<float>(value + std::sqrt(read + shot * value) * normal(generator));
    }
  }
  return image;
}

struct Decoded : PredictedPhases {
  using PredictedPhases::PredictedPhases;
  /// Root mean square of error / sigma, away from the upper and lower border.
  [[nodiscard]] double score(long first_column, long columns) const {
    const auto inner = [&](const Plane& plane) {
      return plane.block(15, first_column, kNoisyRows - 30, columns).cast<double>();
    };
    return std::sqrt(((inner(wrapped) - kPhase) / inner(sigma)).square().mean());
  }
};

/// Samples of 20,000 pixels of which each eightieth is independent: a few per cent.
constexpr double kScoreTolerance = 0.08;

TEST(PhaseNoise, OfWhiteNoiseIsWhatTheWindowLeavesOfIt) {
  const double deviation = 0.01;
  const Decoded decoded(noisy_wave(0.5, 0.3, deviation * deviation, 0, 1));
  EXPECT_NEAR(decoded.score(10, kNoisyColumns - 20), 1, kScoreTolerance);
  // Phase noise of N independent pixels: sqrt(2 / N) sigma / amplitude. N from the window's squared
  // weights, 1.5 / 4 P for Hann's, and 70 / 256 for the binomial average.
  const double pixels = 4 * kPeriod / 3 * 256 / 70;
  EXPECT_NEAR(decoded.sigma(100, 100), std::sqrt(2 / pixels) * deviation / 0.3, 0.1 * deviation);
}

TEST(PhaseNoise, GrowsWithTheLightAsShotNoiseDoes) {
  Plane image = noisy_wave(0.1, 0.06, 0, 1e-4, 2);
  image.rightCols(kNoisyColumns / 2) =
      noisy_wave(0.7, 0.2, 0, 1e-4, 3).rightCols(kNoisyColumns / 2);
  const Decoded decoded(image);
  EXPECT_GT(decoded.noise.quadrature.slope, 0);
  EXPECT_NEAR(decoded.score(10, kNoisyColumns / 2 - 20), 1, 0.15);
  EXPECT_NEAR(decoded.score(kNoisyColumns / 2 + 10, kNoisyColumns / 2 - 20), 1, 0.15);
}

TEST(PhaseNoise, KnowsCorrelatedNoise) {
  // Interpolated pixels, as of a mosaic: every other column is its neighbours' mean.
  Plane image = noisy_wave(0.5, 0.3, 1e-4, 0, 4);
  for (long column = 1; column + 1 < kNoisyColumns; column += 2)
    image.col(column) = (image.col(column - 1) + image.col(column + 1)) / 2;
  EXPECT_NEAR(Decoded(image).score(10, kNoisyColumns - 20), 1, 2 * kScoreTolerance);
}

TEST(PhaseNoise, IsLargeWhereBrightnessSteps) {
  Plane image = noisy_wave(0.5, 0.3, 1e-6, 0, 5);
  for (long row = 0; row < kNoisyRows; ++row) {  // a slanted edge of a darker material
    const long edge = kNoisyColumns / 2 + row / 2;
    for (long column = 0; column < edge && column < kNoisyColumns; ++column)
      image(row, column) *= 0.5F;
  }
  const Decoded decoded(image);
  EXPECT_GT(decoded.sigma(120, 220), 5 * decoded.sigma(120, 50));
  const double score = decoded.score(10, kNoisyColumns - 20);
  EXPECT_GT(score, 0.5);
  EXPECT_LT(score, 1.5);
}

TEST(PhaseNoise, GrowsByTheChromaticErrorOfTheChannelsShares) {
  Plane sigma = Plane::Constant(1, 2, 0.03F);
  Plane red(1, 2);
  red << 0.5F, 0;
  Plane blue(1, 2);
  blue << 0.25F, 0;
  add_chromatic_error({red, blue}, {.red = 0.0064, .blue = 0}, sigma);  // 0.08 rad of red
  EXPECT_NEAR(sigma(0, 0), 0.05, 1e-6);
  EXPECT_NEAR(sigma(0, 1), 0.03, 1e-6);
}

TEST(PhaseNoise, OfTooSmallAFrameIsTheWholeResidual) {
  const DemodulationFilter filter = make_filter(kCarrier);
  const Mask modulated = Mask::Ones(40, 12);  // no room for differences
  const Plane zero = Plane::Zero(40, 12);
  const Plane half = Plane::Constant(40, 12, 0.5F);
  const Combined combined{half, zero, {}};
  const Plane residual = Plane::Constant(40, 12, 0.04F);
  const std::vector<Demodulated> channels = {{half, zero, half}};
  const PhaseSignal signal{.wrapped = zero,
                           .combined = combined,
                           .channels = channels,
                           .residual = residual,
                           .modulated = modulated};
  const FrameNoise noise = estimate_noise(signal, filter);
  EXPECT_EQ(noise.quadrature.constant, 0);
  EXPECT_EQ(noise.residual.slope, 0);
  Plane sigma;
  predict_phase_sigma(signal, noise, filter, sigma);
  // Hann's squared weights sum to 3 / (4 period).
  EXPECT_NEAR(sigma(20, 6), std::sqrt(3 / (8 * kPeriod) * 0.04) / 0.5, 2e-3);
}

}  // namespace
}  // namespace palpate::sensing
