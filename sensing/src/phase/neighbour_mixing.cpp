// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/neighbour_mixing.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "image/hot_loop.h"
#include "image/hue.h"

namespace palpate::sensing {
namespace {

/// Curvature of the phase along the rows counts if its effect exceeds this number of standard
/// deviations.
constexpr float kClearBend = 3;
/// A bend down the window counts by half at this number of its own standard deviations.
constexpr float kHalfBend = 6;
/// [rad] Phases whose slope changes by more from the rows above to those below belong to several
/// surfaces.
constexpr float kLargestBend = 2;
/// Variance of the lens' blur [px^2].
constexpr float kLensBlur = 1;

[[gnu::always_inline]] inline float limited(float value, float largest) {
  const float upper = value < largest ? value : largest;
  return upper > -largest ? upper : -largest;
}

/// Values of pixels and of those on both sides, in a row or in a column.
struct Neighbours {
  const float* before;
  const float* here;
  const float* after;
};

/// `phase` is the input of `out`.
PALPATE_HOT_LOOP void unmix_along_row(Neighbours re, Neighbours im, Neighbours phase,
                                      float variance, long count, float* __restrict out,
                                      float* __restrict sigma) {
  const float steepest = 1 / std::sqrt(variance);
  for (long i = 0; i < count; ++i) {
    const float left = re.before[i] * re.before[i] + im.before[i] * im.before[i];
    const float here = re.here[i] * re.here[i] + im.here[i] * im.here[i];
    const float right = re.after[i] * re.after[i] + im.after[i] * im.after[i];
    const bool known = (left > 0) & (here > 0) & (right > 0);
    const float fade = limited((right - left) / (4 * here), steepest);
    const float before = turned_back(phase.here[i] - phase.before[i]);
    const float after = turned_back(phase.after[i] - phase.here[i]);
    const float bend = (after - before) / 2;
    const float s = sigma[i];
    const bool bent = variance * std::abs(bend) > kClearBend * s;
    const float mixed = fade * (before + after) / 2 + (bent ? bend : 0.0F);
    const float counted = known ? mixed : 0.0F;
    out[i] = turned_back(phase.here[i] - variance * counted);
    sigma[i] = std::sqrt(s * s + kLensBlur * kLensBlur * counted * counted);
  }
}

/// The window that mixes.
struct Mixing {
  float variance = 0;  ///< [px^2]
  float reach = 0;     ///< [px]
};

PALPATE_HOT_LOOP void unmix_down_window(Neighbours re, Neighbours im, Neighbours phase,
                                        Neighbours deviation, Mixing window, long columns,
                                        float* __restrict out, float* __restrict sigma) {
  const float share = window.variance / (window.reach * window.reach);
  const float steepest = 1 / std::sqrt(share);
  for (long i = 0; i < columns; ++i) {
    const float above = re.before[i] * re.before[i] + im.before[i] * im.before[i];
    const float here = re.here[i] * re.here[i] + im.here[i] * im.here[i];
    const float below = re.after[i] * re.after[i] + im.after[i] * im.after[i];
    const bool known = (above > 0) & (here > 0) & (below > 0);
    const float fade = limited((below - above) / (4 * here), steepest);
    const float before = turned_back(phase.here[i] - phase.before[i]);
    const float after = turned_back(phase.after[i] - phase.here[i]);
    const float turn = after - before;
    // A' / A phi' + phi'' / 2, times the square of the reach.
    const float bend = fade * (before + after) / 2 + turn / 2;
    const float s = deviation.here[i];
    const float noise =
        s * s +
        (deviation.before[i] * deviation.before[i] + deviation.after[i] * deviation.after[i]) / 4;
    const float counted = bend * bend / (bend * bend + kHalfBend * kHalfBend * noise);
    const bool bent = known & (noise > 0) & (std::abs(turn) < kLargestBend);
    const float mixed = bent ? share * counted * bend : 0.0F;
    out[i] = turned_back(phase.here[i] - mixed);
    sigma[i] = std::sqrt(s * s + mixed * mixed);
  }
}

/// The last rows of an image that is overwritten from the top, as they were.
class FormerRows {
 public:
  FormerRows(long count, long columns) : rows_(count, columns) {}
  void keep(const Plane& image, long row) { rows_.row(row % rows_.rows()) = image.row(row); }
  [[nodiscard]] const float* at(long row) const { return &rows_(row % rows_.rows(), 0); }

 private:
  Plane rows_;
};

void unmix_window(const PhaseSignal& signal, const DemodulationFilter& filter, Plane& wrapped,
                  Plane& sigma) {
  const long reach = mixing_reach(filter);
  const long columns = wrapped.cols();
  const Mixing window{static_cast<float>(filter.window_variance()), static_cast<float>(reach)};
  FormerRows phases(reach + 1, columns);
  FormerRows sigmas(reach + 1, columns);
  for (long row = 0; row + reach < wrapped.rows(); ++row) {
    phases.keep(wrapped, row);
    sigmas.keep(sigma, row);
    if (row < reach) continue;
    const auto rows = [&](const Plane& image) {
      return Neighbours{&image(row - reach, 0), &image(row, 0), &image(row + reach, 0)};
    };
    unmix_down_window(rows(signal.combined.re), rows(signal.combined.im),
                      {phases.at(row - reach), phases.at(row), &wrapped(row + reach, 0)},
                      {sigmas.at(row - reach), sigmas.at(row), &sigma(row + reach, 0)}, window,
                      columns, &wrapped(row, 0), &sigma(row, 0));
  }
}

}  // namespace

long mixing_reach(const DemodulationFilter& filter) {
  const double periods = std::max(1.0, std::round((2 * filter.radius + 1) / filter.period()));
  return std::lround(periods * filter.period());
}

void unmix_neighbours(const PhaseSignal& signal, const DemodulationFilter& filter, Plane& wrapped,
                      Plane& sigma) {
  const auto variance = static_cast<float>(filter.row_variance());
  const long columns = wrapped.cols();
  std::vector<float> former(static_cast<std::size_t>(columns));
  for (long row = 0; row < wrapped.rows(); ++row) {
    std::copy_n(&wrapped(row, 0), columns, former.data());
    const auto inner = [](const float* values) {
      return Neighbours{values, values + 1, values + 2};
    };
    unmix_along_row(inner(&signal.combined.re(row, 0)), inner(&signal.combined.im(row, 0)),
                    inner(former.data()), variance, columns - 2, &wrapped(row, 0) + 1,
                    &sigma(row, 0) + 1);
  }
  unmix_window(signal, filter, wrapped, sigma);
}

}  // namespace palpate::sensing
