// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/demodulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <vector>

#include "phase/phase_testing.h"

namespace palpate::sensing {
namespace {

constexpr long kWaveRows = 60;
constexpr long kWaveColumns = 9;
/// Sums of 15 products of floats near 1.
constexpr double kSumRounding = 3e-6;

Plane wave(double mean, double amplitude, double frequency, double phase) {
  Plane image(kWaveRows, kWaveColumns);
  for (long row = 0; row < kWaveRows; ++row) {
    image.row(row) = static_cast<float>(
        mean + amplitude * std::cos(frequency * static_cast<double>(row) + phase));
  }
  return image;
}

std::vector<Demodulated> demodulate(const std::vector<Plane>& channels, const Mask& mask,
                                    const DemodulationFilter& filter) {
  Demodulation out;
  demodulate(channels, mask, filter, out);
  return out.channels;
}

Mask everywhere() { return Mask::Ones(kWaveRows, kWaveColumns); }

std::complex<double> at(const Demodulated& signal, long row, long column = 4) {
  return {static_cast<double>(signal.re(row, column)), static_cast<double>(signal.im(row, column))};
}

TEST(Demodulation, FindsMeanAmplitudeAndPhaseExactly) {
  const auto out = demodulate({wave(0.5, 0.3, kCarrier, 1.1), wave(0.2, 0.1, kCarrier, -2)},
                              everywhere(), make_filter(kCarrier));
  for (long row = 3; row < kWaveRows - 3; ++row) {
    EXPECT_NEAR(std::abs(at(out[0], row) - std::polar(0.15, 1.1)), 0, kSumRounding) << row;
    EXPECT_NEAR(std::abs(at(out[1], row) - std::polar(0.05, -2.0)), 0, kSumRounding) << row;
    EXPECT_NEAR(out[0].mean(row, 4), 0.5, kSumRounding) << row;
  }
}

TEST(Demodulation, AnotherFrequencyDoesNotBiasThePhase) {
  // A surface that slopes: 15 % higher frequency.
  const double frequency = 1.15 * kCarrier;
  const auto out =
      demodulate({wave(0.5, 0.3, frequency, 0.4)}, everywhere(), make_filter(kCarrier));
  for (long row = 10; row < kWaveRows - 10; ++row) {
    const double expected = (frequency - kCarrier) * static_cast<double>(row) + 0.4;
    EXPECT_NEAR(std::arg(at(out[0], row) * std::polar(1.0, -expected)), 0, 0.02) << row;
  }
}

TEST(Demodulation, TheSecondHarmonicOfAGammaCurveIsSuppressed) {
  const Plane image = wave(0.5, 0.3, kCarrier, 0.4) + wave(0, 0.1, 2 * kCarrier, 1.9);
  const auto out = demodulate({image}, everywhere(), make_filter(kCarrier));
  for (long row = 10; row < kWaveRows - 10; ++row)
    EXPECT_NEAR(std::arg(at(out[0], row)), 0.4, 0.005);
}

TEST(Demodulation, WhatLiesOutsideTheMaskDoesNotMatter) {
  Plane image = wave(0.5, 0.3, kCarrier, 1.1);
  Mask mask = everywhere();
  mask.topRows(20) = 0;
  image.topRows(20) = 7;
  mask.bottomRows(15) = 0;
  image.bottomRows(15) = 0;
  const auto out = demodulate({image}, mask, make_filter(kCarrier));
  int measured = 0;
  for (long row = 20; row < kWaveRows - 15; ++row) {
    if (at(out[0], row) == 0.0) continue;
    ++measured;
    EXPECT_NEAR(std::abs(at(out[0], row) - std::polar(0.15, 1.1)), 0, kSumRounding) << row;
  }
  constexpr int kLost = 2;  // at each end, where less than three quarters of the window remain
  EXPECT_EQ(measured, 25 - 2 * kLost);
  EXPECT_EQ(at(out[0], 19), 0.0);
}

TEST(Demodulation, TooLittleOfAPeriodIsNotMeasured) {
  Mask mask = Mask::Zero(kWaveRows, kWaveColumns);
  mask.middleRows(30, 3) = 1;
  const auto out = demodulate({wave(0.5, 0.3, kCarrier, 1.1)}, mask, make_filter(kCarrier));
  for (long row = 30; row < 33; ++row) EXPECT_EQ(at(out[0], row), 0.0);
}

TEST(Demodulation, AveragesAlongRowsWithBinomialWeights) {
  Plane image = Plane::Zero(kWaveRows, kWaveColumns);
  image.col(4) = 16 * wave(0.5, 0.3, kCarrier, 1.1).col(4);
  const auto out = demodulate({image}, everywhere(), make_filter(kCarrier));
  const float expected[] = {0, 0, 1, 4, 6, 4, 1, 0, 0};
  for (long column = 0; column < kWaveColumns; ++column) {
    EXPECT_NEAR(std::abs(at(out[0], 30, column) -
                         static_cast<double>(expected[column]) * std::polar(0.15, 1.1)),
                0, 16 * kSumRounding);
    EXPECT_NEAR(out[0].mean(30, column), column == 4 ? 8 : 0, 16 * kSumRounding);
  }
}

TEST(Demodulation, TheResidualIsWhatTheSinusoidDoesNotExplain) {
  Plane image = wave(0.5, 0.3, kCarrier, 1.1);
  Demodulation out;
  demodulate({image, image}, everywhere(), make_filter(kCarrier), out);
  EXPECT_NEAR(out.residual(30, 4), 0, kSumRounding);
  // Rows alternately brighter and darker by 0.1: far from the carrier, all of it stays.
  for (long row = 0; row < kWaveRows; ++row) image.row(row) += row % 2 == 0 ? 0.1F : -0.1F;
  Mask mask = everywhere();
  mask.topRows(20) = 0;  // of windows that are cut, too
  demodulate({image, image}, mask, make_filter(kCarrier), out);
  EXPECT_NEAR(out.residual(40, 4), 2 * 0.01, 5e-4);
  EXPECT_NEAR(out.residual(24, 4), 2 * 0.01, 3e-3);
  EXPECT_EQ(out.residual(10, 4), 0);
}

TEST(Demodulation, ALongerWindowAveragesMorePixels) {
  double before = 1;
  for (const double periods : {1.25, 2.0, 3.0, 4.0}) {
    const DemodulationFilter filter = make_filter(kCarrier, periods);
    double squares = 0;
    for (std::size_t k = 0; k < filter.weight.size(); ++k)
      squares += (k == 0 ? 1 : 2) * std::pow(static_cast<double>(filter.weight[k]), 2);
    EXPECT_NEAR(squares, 1.5 / (periods * kPeriod), 2e-3) << periods;  // Hann's
    EXPECT_LT(squares, before);
    before = squares;
    Demodulation out;
    demodulate({wave(0.5, 0.3, kCarrier, 1.1)}, everywhere(), filter, out);
    EXPECT_NEAR(std::abs(at(out.channels[0], 30) - std::polar(0.15, 1.1)), 0, 2 * kSumRounding)
        << periods;
  }
}

TEST(Demodulation, AveragesAcrossTheSinusoidInProportionToThePeriod) {
  constexpr long kMiddle = 60;
  for (const auto& [period, width] :
       std::vector<std::pair<double, int>>{{3.6, 5}, {7.3, 5}, {12.9, 5}, {13.1, 13}, {41, 29}}) {
    const double carrier = 2 * std::numbers::pi / period;
    const DemodulationFilter filter = make_filter(carrier);
    EXPECT_EQ(filter.width(), width) << period;
    // One column alone shows the sinusoid: the output along the row is the weights.
    Plane image = Plane::Constant(200, 2 * kMiddle + 1, 0.5F);
    for (long row = 0; row < image.rows(); ++row)
      image(row, kMiddle) += static_cast<float>(0.4 * std::cos(carrier * static_cast<double>(row)));
    Demodulation out;
    demodulate({image}, Mask::Ones(image.rows(), image.cols()), filter, out);
    double total = 0;
    double variance = 0;
    for (long column = 0; column < image.cols(); ++column) {
      const double weight = at(out.channels[0], 100, column).real() / 0.2;
      const auto distance = static_cast<double>(column - kMiddle);
      total += weight;
      variance += weight * distance * distance;
      EXPECT_EQ(std::abs(weight) > 1e-6, 2 * std::abs(column - kMiddle) < width) << column;
    }
    EXPECT_NEAR(total, 1, 1e-3) << period;
    const double passes = std::log2((width + 3) / 4);  // their variances are 1, 4, 16, ...
    EXPECT_NEAR(3 * variance / (std::pow(4, passes) - 1), 1, 2e-3) << period;
  }
}

}  // namespace
}  // namespace palpate::sensing
