// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/edge_blur.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace palpate::sensing {
namespace {

constexpr long kEdgeRows = 60;
constexpr long kEdgeColumns = 24;
constexpr double kEdgeCarrier = 2 * std::numbers::pi / 7.3;  // rad/px
constexpr long kDarkRows = 20;                               // rows above the light

/// A sinusoid of full contrast below an edge, blurred by 1 px.
Plane light_below_edge(double phase) {
  constexpr int kParts = 10;  // samples across a pixel
  constexpr int kReach = 5;   // px, of the blur
  Plane light(kEdgeRows, kEdgeColumns);
  for (long row = 0; row < kEdgeRows; ++row) {
    double sum = 0, weights = 0;
    for (int i = -kReach * kParts; i <= kReach * kParts; ++i) {
      const double away = (i + 0.5) / kParts;
      const double at = static_cast<double>(row) + away;
      const double weight = std::exp(-away * away / 2);
      weights += weight;
      if (at > kDarkRows - 0.5) sum += weight * 0.4 * (1 + std::cos(kEdgeCarrier * at + phase));
    }
    light.row(row).setConstant(static_cast<float>(sum / weights));
  }
  return light;
}

Mask lit_below_edge() {
  Mask lit = Mask::Ones(kEdgeRows, kEdgeColumns);
  lit.topRows(kDarkRows) = 0;
  return lit;
}

// The truth is the simulated edge: errors of the phase, RMS over all phases.
TEST(EdgeBlur, PredictsHowMuchABlurredEdgeMovesThePhase) {
  const Mask lit = lit_below_edge();
  const DemodulationFilter filter = make_filter(kEdgeCarrier);
  Plane sigma = Plane::Zero(kEdgeRows, kEdgeColumns);
  add_edge_blur(lit, filter, sigma);
  constexpr int kPhases = 16;
  std::vector<double> squares(kEdgeRows, 0.0);
  for (int i = 0; i < kPhases; ++i) {
    const double phase = 2 * std::numbers::pi * i / kPhases;
    Demodulation found;
    demodulate({light_below_edge(phase)}, lit, filter, found);
    for (long row = kDarkRows; row < kEdgeRows; ++row) {
      const auto re = static_cast<double>(found.channels[0].re(row, kEdgeColumns / 2));
      const auto im = static_cast<double>(found.channels[0].im(row, kEdgeColumns / 2));
      const double miss = std::remainder(std::atan2(im, re) - phase, 2 * std::numbers::pi);
      squares[static_cast<std::size_t>(row)] += miss * miss / kPhases;
    }
  }
  // From the third pixel on there are phases; half a window farther, the edge hardly counts. The
  // prediction leaves out the part that the second pixel lacks, 7 %.
  for (long row = kDarkRows + 2; row < kDarkRows + 6; ++row) {
    const double error = std::sqrt(squares[static_cast<std::size_t>(row)]);
    const auto predicted = static_cast<double>(sigma(row, kEdgeColumns / 2));
    EXPECT_GT(error, 0.7 * predicted) << row;
    EXPECT_LT(error, 2 * predicted) << row;
  }
}

TEST(EdgeBlur, CountsAtTheBorderOfTheImageAndNowhereElse) {
  const DemodulationFilter filter = make_filter(kEdgeCarrier);
  Plane sigma = Plane::Constant(kEdgeRows, kEdgeColumns, 0.01F);
  add_edge_blur(Mask::Ones(kEdgeRows, kEdgeColumns), filter, sigma);
  EXPECT_GT(sigma(0, 3), 0.1F);
  EXPECT_EQ(sigma(0, 3), sigma(kEdgeRows - 1, 3));
  const long reach = filter.radius + 1;
  EXPECT_TRUE((sigma.middleRows(reach, kEdgeRows - 2 * reach) == 0.01F).all());
  EXPECT_GT(sigma(reach - 1, 3), 0.01F);
}

TEST(EdgeBlur, LeavesPixelsInTheDarkAsTheyAre) {
  Plane sigma = Plane::Constant(kEdgeRows, kEdgeColumns, 0.01F);
  add_edge_blur(lit_below_edge(), make_filter(kEdgeCarrier), sigma);
  EXPECT_TRUE((sigma.topRows(kDarkRows) == 0.01F).all());
}

}  // namespace
}  // namespace palpate::sensing
