// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/lit_channels.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace palpate::sensing {
namespace {

constexpr long kLitRows = 20;
constexpr long kLitColumns = 160;
constexpr long kStripeWidth = 20;
constexpr double kSearched = 50;

/// Stripes of the eight sets of channels, 1 and 3 first, as a surface shows them whose brightness
/// falls to a third from left to right.
constexpr std::array<unsigned, 8> kStripeSets{1, 3, 2, 6, 4, 5, 7, 0};

std::vector<Demodulated> seen_on(const std::array<double, 3>& reflectance) {
  std::vector<Demodulated> channels(3);
  for (std::size_t c = 0; c < 3; ++c) {
    channels[c].re = channels[c].im = channels[c].mean = Plane::Zero(kLitRows, kLitColumns);
    for (long column = 0; column < kLitColumns; ++column) {
      const unsigned set = kStripeSets[static_cast<std::size_t>(column / kStripeWidth)];
      const double shade = 1 - 2.0 / 3 * static_cast<double>(column) / kLitColumns;
      const double angle = 0.1 * static_cast<double>(column);
      const double value = (set >> c & 1U) != 0 ? 0.2 * shade * reflectance[c] : 0;
      channels[c].re.col(column) = static_cast<float>(value * std::cos(angle));
      channels[c].im.col(column) = static_cast<float>(value * std::sin(angle));
    }
  }
  return channels;
}

LargestModulation largest_of(const std::vector<Demodulated>& channels) {
  LargestModulation largest(kLitRows, kLitColumns, kSearched);
  for (long row = 0; row < kLitRows; ++row) {
    for (long column = 0; column < kLitColumns; ++column) largest.add(row, column, channels);
  }
  largest.finish();
  return largest;
}

TEST(LitChannels, AreThoseOfTheStripesOnAnyColourThatReflectsAllChannels) {
  for (const std::array<double, 3>& reflectance :
       {std::array<double, 3>{1, 1, 1}, {0.05, 1, 0.04}, {0.3, 0.1, 0.03}}) {
    const auto channels = seen_on(reflectance);
    const LargestModulation largest = largest_of(channels);
    EXPECT_EQ(largest.reflected(), 7);
    EXPECT_EQ(largest.single(), reflectance[0] < 0.1) << reflectance[0];
    for (long column = 0; column < kLitColumns; ++column) {
      EXPECT_EQ(largest.lit(3, column, channels),
                kStripeSets[static_cast<std::size_t>(column / kStripeWidth)])
          << column;
    }
  }
}

TEST(LitChannels, AreLightAndDarkOnASurfaceThatReflectsOneChannel) {
  // A hundredth of the light in green is crosstalk.
  const auto channels = seen_on({0.01, 1, 0});
  const LargestModulation largest = largest_of(channels);
  EXPECT_EQ(largest.reflected(), 2);
  EXPECT_TRUE(largest.single());
  for (long column = 0; column < kLitColumns; ++column) {
    EXPECT_EQ(largest.lit(3, column, channels),
              kStripeSets[static_cast<std::size_t>(column / kStripeWidth)] & 2U)
        << column;
  }
}

TEST(LitChannels, AreNoneOfASurfaceWithoutLight) {
  const auto channels = seen_on({0, 0, 0});
  const LargestModulation largest = largest_of(channels);
  EXPECT_EQ(largest.reflected(), 0);
  EXPECT_EQ(largest.lit(3, 5, channels), 0);
}

}  // namespace
}  // namespace palpate::sensing
