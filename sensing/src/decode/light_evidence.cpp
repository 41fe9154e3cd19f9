// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/light_evidence.h"

#include <array>
#include <cmath>
#include <optional>

namespace palpate::sensing {
namespace {

/// About so many rows are looked at for the light, and so many columns for the steps between rows.
constexpr long kLightLines = 40;
constexpr long kStepColumns = 20;

/// Steps between rows are compared iff the mean square of the sinusoid's slope there, one at its
/// steepest, is at least this.
constexpr double kLeastSlope = 0.15;

/// Of doubled rows, the steps within pairs are less than this share of those between them.
constexpr double kDoubled = 0.05;

/// Steps of brightness from some rows to the next, in proportion to what a sinusoid of unit
/// amplitude and the measured phase makes of them. A period of four pixels would otherwise show the
/// same at every other step.
struct RowSteps {
  double squares = 0;
  double expected = 0;
  long count = 0;

  /// Mean square of the steps; none if the sinusoid is level there.
  [[nodiscard]] std::optional<double> mean() const {
    if (expected < kLeastSlope * static_cast<double>(count) || count == 0) return std::nullopt;
    return squares / expected;
  }
};

/// The same for a sinusoid that runs along the rows of the frame, which are the columns of the
/// working image. Its stripes alone vary across them, and show only whether rows are doubled.
void add_column_steps(const Workspace& work, DecodeEvidence& evidence) {
  const std::vector<Plane>& channels = work.whole.empty() ? work.channels : work.whole;
  const long scale = work.whole.empty() ? 1 : 2;
  const long rows = std::min(channels[0].rows(), scale * work.modulated.rows());
  const long columns = std::min(channels[0].cols(), scale * work.modulated.cols());
  std::array<double, 2> steps{};
  for (long row = 0; row < rows; row += step_for(rows, kStepColumns)) {
    for (long column = 0; column + 1 < columns; ++column) {
      if (work.modulated(row / scale, column / scale) == 0) continue;
      float change = 0;
      for (const Plane& channel : channels)
        change += channel(row, column + 1) - channel(row, column);
      steps[static_cast<std::size_t>(column % 2)] += static_cast<double>(change * change);
    }
  }
  // Sharp stripes may happen to begin at even columns, but not all of them.
  if (std::min(steps[0], steps[1]) > kDoubled * std::max(steps[0], steps[1])) return;
  evidence.steps_in_pairs = steps[0];
  evidence.steps_between_pairs = steps[1];
}

/// Compares the steps of brightness between rows, of the whole frame also at half resolution.
void add_sinusoid_steps(const Workspace& work, double carrier, DecodeEvidence& evidence) {
  const std::vector<Plane>& channels = work.whole.empty() ? work.channels : work.whole;
  const long scale = work.whole.empty() ? 1 : 2;
  const long rows = std::min(channels[0].rows(), scale * work.modulated.rows());
  const long columns = std::min(channels[0].cols(), scale * work.modulated.cols());
  const long step = step_for(columns, kStepColumns);
  std::array<RowSteps, 2> steps;  // in pairs, and between them
  for (long row = 0; row + 1 < rows; ++row) {
    RowSteps& sum = steps[static_cast<std::size_t>(row % 2)];
    const double middle =
        scale == 1 ? static_cast<double>(row) + 0.5 : static_cast<double>(row) / 2;
    for (long column = 0; column < columns; column += step) {
      if (work.modulated(row / scale, column / scale) == 0) continue;
      float change = 0;
      for (const Plane& channel : channels)
        change += channel(row + 1, column) - channel(row, column);
      const double slope = std::sin(static_cast<double>(work.wrapped(row / scale, column / scale)) +
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
        const Demodulated& one = green_red_blue[kOrder[channel]];
        const float re = one.re(row, column), im = one.im(row, column);
        evidence.light[channel] += static_cast<double>(std::sqrt(re * re + im * im));
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

}  // namespace palpate::sensing
