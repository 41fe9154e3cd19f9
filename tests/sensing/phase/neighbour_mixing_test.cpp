// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/neighbour_mixing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "phase/phase_testing.h"

namespace palpate::sensing {
namespace {

/// A row of phasors that were averaged over five pixels: amplitude and phase by the column.
class AveragedRows {
 public:
  template <typename Amplitude, typename Phase>
  AveragedRows(const Amplitude& amplitude, const Phase& phase)
      : truth_(Plane::Zero(3, kColumns)), sigma(Plane::Constant(3, kColumns, kSigma)) {
    constexpr double kWeights[] = {1 / 16.0, 4 / 16.0, 6 / 16.0, 4 / 16.0, 1 / 16.0};
    combined.re = combined.im = wrapped = truth_;
    for (long column = 0; column < kColumns; ++column) {
      std::complex<double> sum = 0;
      for (long i = -2; i <= 2; ++i) {
        const auto place = static_cast<double>(column + i);
        sum += kWeights[i + 2] * std::polar<double>(amplitude(place), phase(place));
      }
      combined.re.col(column) = static_cast<float>(sum.real());
      combined.im.col(column) = static_cast<float>(sum.imag());
      wrapped.col(column) = static_cast<float>(std::arg(sum));
      truth_.col(column) = static_cast<float>(phase(static_cast<double>(column)));
    }
    before = wrapped;
    const Mask modulated = Mask::Ones(3, kColumns);
    const std::vector<Demodulated> channels;
    const PhaseSignal signal{.wrapped = wrapped,
                             .combined = combined,
                             .channels = channels,
                             .residual = truth_,
                             .modulated = modulated};
    unmix_neighbours(signal, make_filter(kCarrier), wrapped, sigma);
  }
  /// [rad] wrapped
  [[nodiscard]] double error(const Plane& of, long column) const {
    return std::remainder(static_cast<double>(of(1, column) - truth_(1, column)),
                          2 * std::numbers::pi);
  }
  static constexpr long kColumns = 60;
  static constexpr float kSigma = 0.001F;

 private:
  Plane truth_;
  Combined combined;

 public:
  Plane before, wrapped, sigma;
};

TEST(UnmixedNeighbours, WhereTheLightFadesASlopeIsNotMovedTowardsTheLight) {
  const AveragedRows rows([](double u) { return std::exp(-0.3 * u); },
                          [](double u) { return 0.3 * u; });
  for (long column = 5; column < 55; ++column) {
    EXPECT_NEAR(rows.error(rows.before, column), -0.09, 0.01) << column;  // V A' / A phi'
    EXPECT_NEAR(rows.error(rows.wrapped, column), 0, 0.01) << column;
    // The lens mixes as much.
    EXPECT_NEAR(static_cast<double>(rows.sigma(1, column)), 0.09, 0.01) << column;
  }
}

TEST(UnmixedNeighbours, ALimbKeepsItsCurvature) {
  const AveragedRows rows([](double) { return 0.2; },
                          [](double u) { return 3 * std::sqrt(std::max(70 - u, 0.0)); });
  for (long column = 50; column < 57; ++column) {
    EXPECT_LT(std::abs(rows.error(rows.wrapped, column)),
              0.3 * std::abs(rows.error(rows.before, column)))
        << column;
  }
}

TEST(UnmixedNeighbours, EvenLightChangesNothing) {
  const AveragedRows rows([](double) { return 0.2; }, [](double u) { return 0.2 * u; });
  for (long column = 5; column < 55; ++column) {
    EXPECT_NEAR(static_cast<double>(rows.wrapped(1, column) - rows.before(1, column)), 0, 1e-5);
    EXPECT_NEAR(static_cast<double>(rows.sigma(1, column)), 0.001, 1e-6);
  }
}

/// Columns of mean + amplitude cos(carrier row + phase), whose amplitude and phase depend on the
/// row, as the window sees them.
class WindowedColumns {
 public:
  template <typename Amplitude, typename Phase>
  WindowedColumns(const Amplitude& amplitude, const Phase& phase, float deviation = kSigma)
      : sigma(Plane::Constant(kRows, kColumns, deviation)) {
    const DemodulationFilter filter = make_filter(kCarrier);
    Plane image(kRows, kColumns);
    for (long row = 0; row < kRows; ++row) {
      const auto place = static_cast<double>(row);
      truth_.push_back(phase(place));
      image.row(row) =
          static_cast<float>(0.5 + amplitude(place) * std::cos(kCarrier * place + truth_.back()));
    }
    const Mask modulated = Mask::Ones(kRows, kColumns);
    Demodulation demodulation;
    demodulate({image}, modulated, filter, demodulation);
    Combined combined;
    combine_channels(demodulation.channels, {}, combined);
    find_wrapped_phase(combined.re, combined.im, wrapped);
    before = wrapped;
    const PhaseSignal signal{.wrapped = wrapped,
                             .combined = combined,
                             .channels = demodulation.channels,
                             .residual = demodulation.residual,
                             .modulated = modulated};
    unmix_neighbours(signal, filter, wrapped, sigma);
  }
  /// [rad] Mean over a period of rows in the middle, where ripples cancel.
  [[nodiscard]] double error(const Plane& of) const {
    double sum = 0;
    for (long row = kRows / 2 - 3; row <= kRows / 2 + 3; ++row) {
      sum += std::remainder(static_cast<double>(of(row, 5)) - truth_[static_cast<std::size_t>(row)],
                            2 * std::numbers::pi);
    }
    return sum / 7;
  }
  /// [rad] in the middle
  [[nodiscard]] double deviation() const { return static_cast<double>(sigma(kRows / 2, 5)); }

  static constexpr long kRows = 101;
  static constexpr long kColumns = 11;
  static constexpr float kSigma = 0.001F;

 private:
  std::vector<double> truth_;

 public:
  Plane before, wrapped, sigma;
};

/// [px^2] Variance of Hann's window of two periods: (1 / 12 - 1 / (2 pi^2)) of its length squared.
constexpr double kVariance =
    (1.0 / 12 - 1 / (2 * std::numbers::pi * std::numbers::pi)) * 4 * kPeriod * kPeriod;
/// Phases of the fit and the sums over its pixels, of the effects below.
constexpr double kEffectTolerance = 0.1;

double even(double) { return 0.3; }

TEST(UnmixedWindow, ABendIsNotRoundedOff) {
  constexpr double kBend = 0.006;  // rad/px^2, as of a fold of a few centimetres
  const WindowedColumns columns(even, [](double row) {
    return kPhase +
           kBend / 2 * (row - WindowedColumns::kRows / 2) * (row - WindowedColumns::kRows / 2);
  });
  const double rounded = kVariance * kBend / 2;
  EXPECT_NEAR(columns.error(columns.before), rounded, kEffectTolerance * rounded);
  EXPECT_LT(std::abs(columns.error(columns.wrapped)), kEffectTolerance * rounded);
  EXPECT_NEAR(columns.deviation(), rounded, kEffectTolerance * rounded);
}

TEST(UnmixedWindow, WhereTheLightFadesASlopeIsNotMovedTowardsTheLight) {
  constexpr double kFade = -0.03, kSlope = 0.06;  // A' / A and phi'
  const auto from_middle = [](double row) { return row - WindowedColumns::kRows / 2; };
  const WindowedColumns columns(
      [&](double row) { return 0.2 * std::exp(kFade * from_middle(row)); },
      [&](double row) { return kPhase + kSlope * from_middle(row); });
  const double moved = kVariance * kFade * kSlope;
  EXPECT_NEAR(columns.error(columns.before), moved, 2 * kEffectTolerance * std::abs(moved));
  EXPECT_LT(std::abs(columns.error(columns.wrapped)), 2 * kEffectTolerance * std::abs(moved));
}

TEST(UnmixedWindow, NoiseIsNoBend) {
  constexpr double kBend = 0.0005;
  const auto bent = [](double row) { return kPhase + kBend / 2 * row * row; };
  constexpr float kNoisy = 0.2F;  // rad: the effect of the bend over the reach is an eighth of it
  const WindowedColumns columns(even, bent, kNoisy);
  const double change = columns.error(columns.wrapped) - columns.error(columns.before);
  EXPECT_LT(std::abs(change), 0.01 * kVariance * kBend / 2);
  EXPECT_NEAR(columns.deviation(), static_cast<double>(kNoisy), 1e-4);
}

TEST(UnmixedWindow, AStepBetweenSurfacesIsNoBend) {
  // The step lies beyond the rows that the middle row sees, before the row it is compared with.
  constexpr long kMiddle = WindowedColumns::kRows / 2;
  const WindowedColumns columns(even,
                                [](double row) { return kPhase + (row > kMiddle + 11 ? 3.0 : 0); });
  EXPECT_NEAR(columns.before(kMiddle, 5), kPhase, 1e-4);
  EXPECT_EQ(columns.wrapped(kMiddle, 5), columns.before(kMiddle, 5));
  EXPECT_EQ(columns.sigma(kMiddle, 5), WindowedColumns::kSigma);
}

TEST(UnmixedWindow, LooksAsFarAsWholePeriods) {
  EXPECT_EQ(mixing_reach(make_filter(kCarrier)), std::lround(2 * kPeriod));
  EXPECT_EQ(mixing_reach(make_filter(-kCarrier, 1.25)), std::lround(kPeriod));
  EXPECT_EQ(mixing_reach(make_filter(kCarrier, 4)), std::lround(4 * kPeriod));
}

TEST(UnmixedWindow, RowsNearTheBordersStayAsTheyAre) {
  const WindowedColumns columns(even, [](double row) { return kPhase + 0.003 * row * row; });
  for (const long row : {0L, mixing_reach(make_filter(kCarrier)) - 1, WindowedColumns::kRows - 1}) {
    EXPECT_EQ(columns.wrapped(row, 5), columns.before(row, 5)) << row;
  }
}

}  // namespace
}  // namespace palpate::sensing
