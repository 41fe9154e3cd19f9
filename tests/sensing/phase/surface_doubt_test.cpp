// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/surface_doubt.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "phase/wrapped_phase.h"

namespace palpate::sensing {
namespace {

constexpr long kDoubtRows = 200, kDoubtColumns = 80, kMiddleRow = 100, kMiddleColumn = 40;
constexpr double kDoubtPeriod = 24;                         // px
constexpr double kColumnTurns = 2 * std::numbers::pi / 10;  ///< [rad/px]; a crest at the jump

/// Light and sinusoid of a surface at a pixel.
struct Seen {
  double light = 0.4;
  double modulation = 0.8;
  double phase = 0;  ///< [rad]
};

/// Share of the light at a column that a channel shows; all of it by default.
using Shares = std::vector<std::function<double(double)>>;

/// The doubt about a surface; the phase is known everywhere.
SurfaceDoubt doubt_about(const std::function<Seen(double, double)>& surface,
                         const Shares& shares = {[](double) { return 1.0; }},
                         bool steps_show = true) {
  std::vector<Plane> images(shares.size(), Plane(kDoubtRows, kDoubtColumns));
  for (long row = 0; row < kDoubtRows; ++row) {
    for (long column = 0; column < kDoubtColumns; ++column) {
      const Seen seen = surface(static_cast<double>(row), static_cast<double>(column));
      const double value = seen.light * (1 + seen.modulation * std::cos(seen.phase));
      for (std::size_t i = 0; i < shares.size(); ++i)
        images[i](row, column) = static_cast<float>(value * shares[i](static_cast<double>(column)));
    }
  }
  const Mask lit = Mask::Ones(kDoubtRows, kDoubtColumns);
  const DemodulationFilter filter = make_filter(2 * std::numbers::pi / kDoubtPeriod);
  DemodulationFilter narrow = filter;
  narrow.averages = 1;
  Demodulation wide, sharp;
  demodulate(images, lit, filter, wide);
  demodulate(images, lit, narrow, sharp);
  const auto combined = [](const Demodulation& from) {
    Combined to;
    to.re = Plane::Zero(kDoubtRows, kDoubtColumns);
    to.im = to.re;
    for (const Demodulated& channel : from.channels) {
      to.re += channel.re;
      to.im += channel.im;
    }
    return to;
  };
  const Combined combined_wide = combined(wide), combined_sharp = combined(sharp);
  Plane wrapped, variance;
  find_wrapped_phase(combined_wide.re, combined_wide.im, wrapped);
  phase_variance(wrapped, lit, variance);
  SurfaceDoubt doubt;
  find_surface_doubt({.channels = wide.channels,
                      .combined = combined_wide,
                      .sharp = combined_sharp,
                      .wrapped = wrapped,
                      .variance = variance},
                     filter, {.max_variance = 0.01, .steps_show = steps_show}, doubt);
  return doubt;
}

double phase_at(double row, double periods = 0, double frequency = 1) {
  return 2 * std::numbers::pi * (frequency * (row - kMiddleRow) / kDoubtPeriod + periods);
}

/// The largest doubt in some columns, away from the image's border, where the windows are cut.
float most(const Plane& doubt, long columns = kDoubtColumns - 8) {
  const long cut = static_cast<long>(2 * kDoubtPeriod);
  return doubt.block(cut, 4, kDoubtRows - 2 * cut, columns).maxCoeff();
}

TEST(SurfaceDoubt, IsSmallOnSmoothRelief) {
  const SurfaceDoubt doubt = doubt_about([](double row, double column) {
    return Seen{.light = 0.4 + 0.1 * std::sin(row / 25) * std::cos(column / 20),
                .modulation = 0.8 - 0.1 * std::cos(row / 30),
                .phase = phase_at(row, 0.08 * std::sin(row / 30) * std::cos(column / 15))};
  });
  EXPECT_LT(most(doubt.down), 0.5F);
  EXPECT_LT(most(doubt.across), 0.5F);
}

TEST(SurfaceDoubt, SeesAJumpOfThePhaseOrTheLightAcrossTheColumns) {
  for (const double jump : {0.13, 0.25, -0.4, 3.5}) {
    const SurfaceDoubt doubt = doubt_about([&](double row, double column) {
      return Seen{.phase = phase_at(
                      row, column > kMiddleColumn ? jump + 0.01 * (column - kMiddleColumn) : 0)};
    });
    EXPECT_GT(doubt.across.col(kMiddleColumn).segment(30, 140).minCoeff(), 1.0F) << jump;
    EXPECT_LT(most(doubt.across, 16), 0.1F);
  }
  const SurfaceDoubt doubt = doubt_about([](double row, double column) {
    return Seen{.light = column > kMiddleColumn ? 0.4 : 0.2, .phase = phase_at(row)};
  });
  EXPECT_GT(doubt.across.col(kMiddleColumn).segment(30, 140).minCoeff(), 1.0F);
}

// Halfway between two blurred colours no channel is bright.
TEST(SurfaceDoubt, IsSmallWhereAnotherChannelBecomesTheBrightest) {
  const auto surface = [](double row, double) { return Seen{.phase = phase_at(row)}; };
  const auto first = [](double column) {
    return 1 / (1 + std::exp((column - kMiddleColumn) / 0.8));
  };
  const auto second = [&](double column) { return 1 - first(column); };
  EXPECT_GT(most(doubt_about(surface, {first}).across), 1.0F);
  EXPECT_LT(most(doubt_about(surface, {first, second}).across), 0.5F);
}

// The phase goes on over a step of whole periods, but not the frequency or the material.
TEST(SurfaceDoubt, SeesAStepOfWholePeriodsDownTheColumns) {
  const auto step = [](double frequency, double modulation) {
    return doubt_about([=](double row, double) {
      const bool behind = row > kMiddleRow;
      return Seen{.modulation = behind ? modulation : 0.8,
                  .phase = phase_at(row, behind ? 3 : 0, behind ? frequency : 1)};
    });
  };
  for (const auto& doubt : {step(1.45, 0.8), step(1, 0.3), step(1.3, 0.4)})
    EXPECT_GT(doubt.down.row(kMiddleRow).minCoeff(), 1.0F);
}

// Of some columns only, so that most of the image is smooth.
TEST(SurfaceDoubt, SeesAJumpOfThePhaseDownTheColumns) {
  for (const double jump : {0.06, 0.13, -0.25, 3.4}) {
    const SurfaceDoubt doubt = doubt_about([&](double row, double column) {
      return Seen{.phase =
                      phase_at(row, row > kMiddleRow && column > kMiddleColumn + 10 ? jump : 0)};
    });
    EXPECT_GT(doubt.down.row(kMiddleRow).tail(20).minCoeff(), 1.0F) << jump;
    EXPECT_LT(doubt.down.row(kMiddleRow).head(kMiddleColumn).maxCoeff(), 0.1F) << jump;
  }
}

// The slope of the phase against that of the carrier is known up to a turn a period.
TEST(SurfaceDoubt, SeesNoJumpWhereTheFrequencyPassesHalfATurnBesideTheCarrier) {
  const SurfaceDoubt doubt = doubt_about([](double row, double) {
    const double away = row - kMiddleRow;
    return Seen{.phase = phase_at(row, -0.5 * away / kDoubtPeriod - 1e-5 * away * away)};
  });
  // The frequency is half the carrier's, which alone makes a doubt of a quarter. The slopes reach
  // one and a half periods away, to windows of one period.
  const long cut = static_cast<long>(2.5 * kDoubtPeriod);
  EXPECT_LT(doubt.down.middleRows(cut, kDoubtRows - 2 * cut).maxCoeff(), 0.5F);
}

// Where half of the surface is uneven, smaller changes are no steps.
TEST(SurfaceDoubt, SeesSmallJumpsOnSmoothSurfacesOnly) {
  const auto doubt_at_jump = [](double relief) {
    const SurfaceDoubt doubt = doubt_about([&](double row, double column) {
      return Seen{.phase = phase_at(row, (column > kMiddleColumn ? 0.04 : 0) +
                                             relief * std::cos(column * kColumnTurns))};
    });
    return doubt.across.col(kMiddleColumn).segment(30, 140).minCoeff();
  };
  EXPECT_GT(doubt_at_jump(0), 1.0F);
  EXPECT_LT(doubt_at_jump(0.08), 1.0F);
}

TEST(SurfaceDoubt, SeesSmallerChangesIfTheSinusoidHardlyShowsSteps) {
  const Shares all = {[](double) { return 1.0; }};
  const auto brighter = [](double row, double) {
    return Seen{.light = row > kMiddleRow ? 0.45 : 0.25, .phase = phase_at(row)};
  };
  EXPECT_LT(doubt_about(brighter).down.row(kMiddleRow).maxCoeff(), 0.5F);
  EXPECT_GT(doubt_about(brighter, all, false).down.row(kMiddleRow).minCoeff(), 1.0F);
  // Of another frequency and material.
  const auto changed = [](double row, double) {
    const bool behind = row > kMiddleRow;
    return Seen{.modulation = behind ? 0.55 : 0.8,
                .phase = phase_at(row, behind ? 3 : 0, behind ? 1.18 : 1)};
  };
  EXPECT_LT(doubt_about(changed).down.row(kMiddleRow).maxCoeff(), 1.0F);
  EXPECT_GT(doubt_about(changed, all, false).down.row(kMiddleRow).minCoeff(), 1.0F);
}

TEST(SurfaceDoubt, IsInfiniteWhereThePhaseIsUnknown) {
  const Plane none = Plane::Constant(30, 20, std::numeric_limits<float>::infinity());
  const std::vector<Demodulated> channels(1, {none, none, none});
  Combined combined;
  combined.re = none;
  combined.im = none;
  SurfaceDoubt doubt;
  find_surface_doubt({.channels = channels,
                      .combined = combined,
                      .sharp = combined,
                      .wrapped = Plane::Zero(30, 20),
                      .variance = none},
                     make_filter(1), {.max_variance = 0.01}, doubt);
  EXPECT_TRUE(doubt.down.isInf().all());
  EXPECT_TRUE(doubt.across.isInf().all());
}

}  // namespace
}  // namespace palpate::sensing
