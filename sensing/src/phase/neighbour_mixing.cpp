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

/// One row; `phase` is the input of `out`.
PALPATE_HOT_LOOP void unmix_along_row(const float* re, const float* im, const float* phase,
                                      float variance, long columns, float* __restrict out,
                                      float* __restrict sigma) {
  const float steepest = 1 / std::sqrt(variance);
  for (long i = 1; i < columns - 1; ++i) {
    const float left = re[i - 1] * re[i - 1] + im[i - 1] * im[i - 1];
    const float here = re[i] * re[i] + im[i] * im[i];
    const float right = re[i + 1] * re[i + 1] + im[i + 1] * im[i + 1];
    const bool known = (left > 0) & (here > 0) & (right > 0);
    const float fade = limited((right - left) / (4 * here), steepest);
    const float before = turned_back(phase[i] - phase[i - 1]);
    const float after = turned_back(phase[i + 1] - phase[i]);
    const float bend = (after - before) / 2;
    const float s = sigma[i];
    const bool bent = variance * std::abs(bend) > kClearBend * s;
    const float mixed = fade * (before + after) / 2 + (bent ? bend : 0.0F);
    const float counted = known ? mixed : 0.0F;
    out[i] = turned_back(phase[i] - variance * counted);
    sigma[i] = std::sqrt(s * s + kLensBlur * kLensBlur * counted * counted);
  }
}

/// Values of three rows: above, here and below.
struct ThreeRows {
  const float* above;
  const float* here;
  const float* below;
};

/// The window that mixes.
struct Mixing {
  float variance = 0;  ///< [px^2]
  float reach = 0;     ///< [px]
};

PALPATE_HOT_LOOP void unmix_down_window(ThreeRows re, ThreeRows im, ThreeRows phase,
                                        ThreeRows deviation, Mixing window, long columns,
                                        float* __restrict out, float* __restrict sigma) {
  const float share = window.variance / (window.reach * window.reach);
  const float steepest = 1 / std::sqrt(share);
  for (long i = 0; i < columns; ++i) {
    const float above = re.above[i] * re.above[i] + im.above[i] * im.above[i];
    const float here = re.here[i] * re.here[i] + im.here[i] * im.here[i];
    const float below = re.below[i] * re.below[i] + im.below[i] * im.below[i];
    const bool known = (above > 0) & (here > 0) & (below > 0);
    const float fade = limited((below - above) / (4 * here), steepest);
    const float before = turned_back(phase.here[i] - phase.above[i]);
    const float after = turned_back(phase.below[i] - phase.here[i]);
    const float turn = after - before;
    // A' / A phi' + phi'' / 2, times the square of the reach.
    const float bend = fade * (before + after) / 2 + turn / 2;
    const float s = deviation.here[i];
    const float noise =
        s * s +
        (deviation.above[i] * deviation.above[i] + deviation.below[i] * deviation.below[i]) / 4;
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
      return ThreeRows{&image(row - reach, 0), &image(row, 0), &image(row + reach, 0)};
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
  std::vector<float> before(static_cast<std::size_t>(columns));
  for (long row = 0; row < wrapped.rows(); ++row) {
    std::copy_n(&wrapped(row, 0), columns, before.data());
    unmix_along_row(&signal.combined.re(row, 0), &signal.combined.im(row, 0), before.data(),
                    variance, columns, &wrapped(row, 0), &sigma(row, 0));
  }
  unmix_window(signal, filter, wrapped, sigma);
}

}  // namespace palpate::sensing
