// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/surface_doubt.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "phase/phase_testing.h"

namespace palpate::sensing {
namespace {

constexpr long kDoubtRows = 120;
constexpr long kDoubtColumns = 60;
constexpr double kMaxVariance = 0.01;  // [rad^2]
constexpr double kLightContrast = 0.125;
/// [px] Windows at the border of the image are cut.
constexpr long kCutWindows = 10;

/// What a surface shows at a place: brightness (1 + modulation cos(phase)).
struct Appearance {
  double brightness = 0.5;
  double modulation = 0.9;
  double phase = 0;  ///< [rad]
};

Plane doubt_of(const std::function<Appearance(double row, double column)>& surface) {
  Plane image(kDoubtRows, kDoubtColumns);
  for (long row = 0; row < kDoubtRows; ++row) {
    for (long column = 0; column < kDoubtColumns; ++column) {
      const Appearance shown = surface(static_cast<double>(row), static_cast<double>(column));
      image(row, column) =
          static_cast<float>(shown.brightness * (1 + shown.modulation * std::cos(shown.phase)));
    }
  }
  const PredictedPhases seen(image);
  const Plane variance = variance_of(seen.wrapped);
  Plane doubt;
  find_surface_doubt({.channels = seen.demodulation.channels,
                      .combined = seen.combined,
                      .wrapped = seen.wrapped,
                      .variance = variance,
                      .sigma = seen.sigma},
                     seen.filter, {.variance = kMaxVariance, .light = kLightContrast}, doubt);
  return doubt.block(kCutWindows, kCutWindows, kDoubtRows - 2 * kCutWindows,
                     kDoubtColumns - 2 * kCutWindows);
}

double carrier_at(double row) { return kCarrier * row + kPhase; }

TEST(SurfaceDoubt, ASmoothSurfaceHasLittle) {
  EXPECT_LT(
      doubt_of([](double row, double) { return Appearance{.phase = carrier_at(row)}; }).maxCoeff(),
      0.1F);
  // Slopes, shading and unevenness over tens of pixels.
  const Plane doubt = doubt_of([](double row, double column) {
    return Appearance{.brightness = 0.4 + 0.002 * row - 0.002 * column,
                      .modulation = 0.7 + 0.001 * row,
                      .phase = 1.05 * carrier_at(row) + 0.5 * std::sin(column / 15)};
  });
  EXPECT_LT(doubt.maxCoeff(), 1);
}

/// The smallest doubt on the way over an edge between two rows.
float across_rows(const Plane& doubt) {
  const long edge = kDoubtRows / 2 - kCutWindows;
  return doubt.middleRows(edge - 2, 4).colwise().maxCoeff().minCoeff();
}

TEST(SurfaceDoubt, TellsSurfacesOfEqualPhaseApartByTheirLooks) {
  constexpr double kEdge = kDoubtRows / 2;
  const auto with = [&](const Appearance& other, double frequency) {
    return across_rows(doubt_of([&](double row, double) {
      Appearance shown = row < kEdge ? Appearance{} : other;
      shown.phase = carrier_at(kEdge) + kCarrier * (row - kEdge) * (row < kEdge ? 1 : frequency);
      return shown;
    }));
  };
  EXPECT_LT(with({}, 1), 0.1F);
  EXPECT_GE(with({.modulation = 0.3}, 1), 1);
  EXPECT_GE(with({.modulation = 0.5}, 1.3), 1);
  EXPECT_GE(with({}, 1.6), 1);
}

TEST(SurfaceDoubt, AnEdgeOfTheLightAcrossTheRowsIsOneOfTheSurface) {
  const Plane doubt = doubt_of([](double row, double column) {
    return Appearance{.brightness = column < kDoubtColumns / 2 ? 0.5 : 0.36,
                      .phase = carrier_at(row)};
  });
  const long edge = kDoubtColumns / 2 - kCutWindows;
  EXPECT_GE(doubt.middleCols(edge - 2, 4).rowwise().maxCoeff().minCoeff(), 1);
  EXPECT_LT(doubt.leftCols(edge - 6).maxCoeff(), 0.3F);
}

}  // namespace
}  // namespace palpate::sensing
