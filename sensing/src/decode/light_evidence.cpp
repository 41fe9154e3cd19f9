// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/light_evidence.h"

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>

namespace palpate::sensing {
namespace {

/// About this number of rows is used for the light, and of columns for the steps between rows.
constexpr long kLightLines = 40;
constexpr long kStepColumns = 20;

/// Steps between rows are compared if the mean square of the sinusoid's slope there, one at its
/// steepest, is at least this.
constexpr double kLeastSlope = 0.15;

/// Of doubled rows, the steps within pairs are less than this share of those between them.
constexpr double kDoubled = 0.05;

/// Of swapped rows, which take one step back and three ahead, the mean product of successive steps
/// is less than this times their mean square. It is above zero at blurred edges, about -0.3 beside
/// the rims of sharpened ones, and -0.5 of noise alone, whose steps are the same everywhere.
constexpr double kBackwards = -0.4;

/// A sinusoid runs across its expected axis if its amplitude is at least this share of the mean.
constexpr double kContrastAcross = 0.3;

/// The decoded part of the frame at full size.
struct FullSize {
  explicit FullSize(const Workspace& work)
      : halved(!work.full_size.empty()),
        channels(halved ? work.full_size : work.channels),
        scale(halved ? 2 : 1),
        top(halved ? scale * work.part.row : 0),
        left(halved ? scale * work.part.column : 0),
        rows(scale * work.modulated.rows()),
        columns(scale * work.modulated.cols()) {}

  /// Change of all channels together from a pixel to another one.
  [[nodiscard]] float change(long row, long column, long down, long right) const {
    float change = 0;
    for (const Plane& channel : channels)
      change +=
          channel(top + row + down, left + column + right) - channel(top + row, left + column);
    return change;
  }

  bool halved;  ///< for decoding
  const std::vector<Plane>& channels;
  long scale;
  long top;  ///< of the part in the channels [px]
  long left;
  long rows;  ///< of the part
  long columns;
};

/// Steps of brightness from some rows to the next, relative to those of a sinusoid of unit
/// amplitude and the measured phase. With a period of four pixels every other step would otherwise
/// be the same.
struct RowSteps {
  double squares = 0;
  double expected = 0;
  long count = 0;

  /// Mean square of the steps; nullopt if the sinusoid is level there.
  [[nodiscard]] std::optional<double> mean() const {
    if (expected < kLeastSlope * static_cast<double>(count) || count == 0) return std::nullopt;
    return squares / expected;
  }
};

/// The same for a sinusoid that runs along the rows of the frame, which are the columns of the
/// working image. Its stripes alone vary across them, and show only whether rows are doubled or
/// swapped.
void add_column_steps(const Workspace& work, DecodeEvidence& evidence) {
  const FullSize frame(work);
  std::array<double, 2> steps{};
  double products = 0;
  for (long row = 0; row < frame.rows; row += step_for(frame.rows, kStepColumns)) {
    float last = 0;
    for (long column = 0; column + 1 < frame.columns; ++column) {
      const bool seen = work.modulated(row / frame.scale, column / frame.scale) != 0;
      const float change = seen ? frame.change(row, column, 0, 1) : 0;
      steps[static_cast<std::size_t>(column % 2)] += static_cast<double>(change * change);
      products += static_cast<double>(last * change);
      last = change;
    }
  }
  // Sharp stripes may happen to begin at even columns, but not all of them.
  const bool doubled = std::min(steps[0], steps[1]) <= kDoubled * std::max(steps[0], steps[1]);
  const bool swapped = products < kBackwards * (steps[0] + steps[1]);
  if (!doubled && !swapped) return;
  evidence.steps_in_pairs = steps[0];
  evidence.steps_between_pairs = steps[1];
}

/// Compares the steps of brightness between rows, of the whole frame also at half resolution.
void add_sinusoid_steps(const Workspace& work, double carrier, DecodeEvidence& evidence) {
  const FullSize frame(work);
  const long step = step_for(frame.columns, kStepColumns);
  std::array<RowSteps, 2> steps;  // in pairs, and between them
  for (long row = 0; row + 1 < frame.rows; ++row) {
    RowSteps& sum = steps[static_cast<std::size_t>(row % 2)];
    const double middle =
        frame.halved ? static_cast<double>(row) / 2 : static_cast<double>(row) + 0.5;
    const long decoded_row = row / frame.scale;
    for (long column = 0; column < frame.columns; column += step) {
      const long decoded_column = column / frame.scale;
      if (work.modulated(decoded_row, decoded_column) == 0) continue;
      const float change = frame.change(row, column, 1, 0);
      const double slope = std::sin(static_cast<double>(work.wrapped(decoded_row, decoded_column)) +
                                    carrier * middle);
      sum.squares += static_cast<double>(change * change);
      sum.expected += slope * slope;
      ++sum.count;
    }
  }
  const auto in = steps[0].mean(), between = steps[1].mean();
  if (!in || !between) return;
  const auto weight = static_cast<double>(steps[0].count);
  evidence.steps_in_pairs = weight * *in;
  evidence.steps_between_pairs = weight * *between;
}

}  // namespace

void add_light(const Workspace& work, DecodeEvidence& evidence) {
  const auto& green_red_blue = work.demodulated.channels;
  constexpr std::array<std::size_t, 3> kOrder{1, 0, 2};
  for (long row = 0; row < work.modulated.rows();
       row += step_for(work.modulated.rows(), kLightLines)) {
    for (long column = 0; column < work.modulated.cols(); ++column) {
      if (work.modulated(row, column) == 0) continue;
      for (std::size_t channel = 0; channel < kOrder.size(); ++channel) {
        const float power = green_red_blue[kOrder[channel]].power(row, column);
        evidence.light[channel] += static_cast<double>(std::sqrt(power));
      }
    }
  }
}

void add_row_steps(const Workspace& work, const Carrier& carrier, DecodeEvidence& evidence) {
  if (carrier.transposed) {
    add_column_steps(work, evidence);
  } else {
    add_sinusoid_steps(work, carrier.along, evidence);
  }
}

void add_sinusoid_across(const Workspace& work, double carrier, long step,
                         DecodeEvidence& evidence) {
  const long rows = work.lit.rows(), columns = work.lit.cols();
  const auto period = std::max(2L, std::lround(2 * std::numbers::pi / carrier));
  const long reach = 2 * period;  // of a Hann window
  // Its period in the image is known only roughly, because it depends on the pattern's right axis.
  constexpr std::array<double, 3> kFactors{0.8, 1, 1.25};
  for (long row = 0; row < rows; row += step) {
    for (long middle = reach; middle + reach < columns; middle += period) {
      if (work.lit.row(row).segment(middle - reach, 2 * reach + 1).minCoeff() == 0) continue;
      double mean = 0;
      std::array<std::complex<double>, kFactors.size()> waves{};
      for (long d = -reach; d <= reach; ++d) {
        double light = 0;
        for (const Plane& channel : work.channels)
          light += static_cast<double>(channel(row, middle + d));
        light *= 1 + std::cos(std::numbers::pi * static_cast<double>(d) /
                              static_cast<double>(reach + 1));
        mean += light;
        for (std::size_t i = 0; i < waves.size(); ++i)
          waves[i] += std::polar(light, kFactors[i] * carrier * static_cast<double>(d));
      }
      const auto strong = [&](const std::complex<double>& wave) {
        return 2 * std::abs(wave) >= kContrastAcross * mean;
      };
      if (std::any_of(waves.begin(), waves.end(), strong)) evidence.across += period;
    }
  }
}

}  // namespace palpate::sensing
