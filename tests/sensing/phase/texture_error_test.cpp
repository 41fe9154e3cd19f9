// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/texture_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "phase/phase_testing.h"

namespace palpate::sensing {
namespace {

constexpr long kTexturedRows = 240;
constexpr long kTexturedColumns = 320;
constexpr double kTextureNoise = 0.002;  // of full scale
constexpr long kAwayFromBorder = 20;     // px

/// A sinusoid on a surface of some brightness at each row and column, with noise.
Plane wave_on(const std::function<double(long, long)>& brightness, double mean) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, kTextureNoise);
  Plane image(kTexturedRows, kTexturedColumns);
  for (long row = 0; row < image.rows(); ++row) {
    const double wave = mean + 0.3 * std::cos(kCarrier * static_cast<double>(row) + kPhase);
    for (long column = 0; column < image.cols(); ++column)
      image(row, column) = static_cast<float>(brightness(row, column) * wave + noise(random));
  }
  return image;
}

struct OnTexture : PredictedPhases {
  OnTexture(const std::function<double(long, long)>& brightness, double mean)
      : PredictedPhases(wave_on(brightness, mean)), without(sigma), with(sigma) {
    add_texture_error(demodulation.channels, combined, filter, with);
  }
  /// Root mean square of error / deviation.
  [[nodiscard]] double score(const Plane& deviation) const {
    const auto inner = [](const Plane& plane) {
      return plane
          .block(kAwayFromBorder, kAwayFromBorder, kTexturedRows - 2 * kAwayFromBorder,
                 kTexturedColumns - 2 * kAwayFromBorder)
          .cast<double>();
    };
    return std::sqrt(((inner(wrapped) - kPhase) / inner(deviation)).square().mean());
  }
  Plane without, with;  ///< texture error; [rad]
};

/// Square tiles, each of one random brightness.
std::function<double(long, long)> tiles(long edge) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> any(0.4, 1);
  const Eigen::ArrayXXd brightness = Eigen::ArrayXXd::NullaryExpr(
      kTexturedRows / edge + 1, kTexturedColumns / edge + 1, [&] { return any(random); });
  return [=](long row, long column) { return brightness(row / edge, column / edge); };
}

TEST(TextureError, MakesTheDeviationThatOfThePhasesOnTiles) {
  for (const long edge : {6L, 9L, 13L, 20L, 30L}) {
    const OnTexture phases(tiles(edge), 0.4);
    // Beside larger tiles the residual tells enough.
    if (edge < 20) {
      EXPECT_GT(phases.score(phases.without), 1.5) << edge;
    }
    EXPECT_GT(phases.score(phases.with), 0.6) << edge;
    EXPECT_LT(phases.score(phases.with), 1.4) << edge;
  }
}

TEST(TextureError, IsNoneWithoutTextureAndWhereTheLightChangesEvenly) {
  const OnTexture plain([](long, long) { return 0.8; }, 0.4);
  EXPECT_TRUE((plain.with == plain.without).all());
  const OnTexture shaded([](long row, long) { return 0.4 + 0.002 * static_cast<double>(row); },
                         0.4);
  EXPECT_TRUE((shaded.with == shaded.without).all());
}

TEST(TextureError, IsSeenAlsoWhereTheLightDoesNotBend) {
  // Between the crests of a texture of two periods, where it still disturbs the phase.
  const OnTexture wave(
      [](long row, long) { return 0.7 + 0.2 * std::cos(kCarrier / 2 * static_cast<double>(row)); },
      0.4);
  const Plane inner = wave.with.block(kAwayFromBorder, 0, kTexturedRows - 2 * kAwayFromBorder, 1);
  EXPECT_GT(inner.minCoeff(), inner.maxCoeff() / 3);
  EXPECT_GT(wave.score(wave.with), 0.5);
  EXPECT_LT(wave.score(wave.with), 1.5);
}

TEST(TextureError, NeverLowersADeviationAndDoesNotDependOnTheUnitOfTheLight) {
  OnTexture phases(tiles(14), 0.4);
  EXPECT_TRUE((phases.with >= phases.without).all());
  Plane again = phases.without;
  for (Demodulated& channel : phases.demodulation.channels) {
    for (Plane* plane : {&channel.mean, &channel.re, &channel.im}) *plane *= 4;
  }
  combine_channels(phases.demodulation.channels, {}, phases.combined);
  add_texture_error(phases.demodulation.channels, phases.combined, phases.filter, again);
  EXPECT_TRUE((again == phases.with).all());
}

TEST(TextureError, NeedsNoMoreRowsThanThereAre) {
  const Plane one = Plane::Ones(4, 3);
  Plane sigma = one;
  add_texture_error({{one, one, one}}, {one, one, {}}, make_filter(kCarrier), sigma);
  EXPECT_TRUE((sigma == one).all());
}

}  // namespace
}  // namespace palpate::sensing
