// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/texture_error.h"

#include <algorithm>
#include <cmath>

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

/// Variance of the phase [rad^2] for a squared bend of the light over |sum|^2.
constexpr float kVariance = 0.019F;
/// Bend over |sum| that surfaces without texture have.
constexpr float kUsual = 0.2F;

/// Adds the second difference of one channel's mean where it is known.
PALPATE_HOT_LOOP void add_bend(const float* above, const float* here, const float* below,
                               long columns, float* __restrict bend) {
  for (long i = 0; i < columns; ++i) {
    const bool known = (above[i] != 0) & (here[i] != 0) & (below[i] != 0);
    bend[i] += known ? above[i] - 2 * here[i] + below[i] : 0.0F;
  }
}

/// The bends of the rows around one, and the common phasor there.
struct RaisedRow {
  const float* above;  ///< half a period up
  const float* here;
  const float* below;
  const float* re;
  const float* im;
};

PALPATE_HOT_LOOP void raise_row(RaisedRow row, long columns, float* __restrict sigma) {
  const RaisedRow r = row;
  for (long i = 0; i < columns; ++i) {
    const float beside = (r.above[i] * r.above[i] + r.below[i] * r.below[i]) / 2;
    const float squared = (r.here[i] * r.here[i] + beside) / 2;
    const float relative = squared / (r.re[i] * r.re[i] + r.im[i] * r.im[i]);
    const float variance = kVariance * (relative - kUsual * kUsual);
    sigma[i] = variance > sigma[i] * sigma[i] ? std::sqrt(variance) : sigma[i];
  }
}

}  // namespace

void add_texture_error(const std::vector<Demodulated>& channels, const Combined& sum,
                       const DemodulationFilter& filter, Plane& sigma) {
  const long period = std::lround(filter.period());
  const long half = std::lround(filter.period() / 2);
  const long rows = sigma.rows();
  const long columns = sigma.cols();
  // The last rows of bends; zero where a row has no others a period up and down.
  const long kept = 2 * half + 1;
  Plane bends = Plane::Zero(kept, columns);
  const auto bend = [&](long row) { return &bends((row + kept) % kept, 0); };
  for (long row = 0; row < rows + half; ++row) {
    float* const entering = bend(row);
    std::fill_n(entering, columns, 0.0F);
    for (const Demodulated& channel : channels) {
      if (row < period || row + period >= rows) break;
      add_bend(&channel.mean(row - period, 0), &channel.mean(row, 0),
               &channel.mean(row + period, 0), columns, entering);
    }
    const long center = row - half;
    if (center < 0) continue;
    raise_row({.above = bend(center - half),
               .here = bend(center),
               .below = entering,
               .re = &sum.re(center, 0),
               .im = &sum.im(center, 0)},
              columns, &sigma(center, 0));
  }
}

}  // namespace palpate::sensing
