// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/texture_error.h"

#include <cmath>

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

/// Variance of the phase [rad^2] for a squared second difference of the light over |sum|^2.
constexpr float kVariance = 0.04F;
/// Second difference over |sum| that surfaces without texture have.
constexpr float kUsual = 0.2F;

/// Adds the second difference of one channel's mean where it is known.
PALPATE_HOT_LOOP void add_bend(const float* above, const float* here, const float* below,
                               long columns, float* __restrict bend) {
  for (long i = 0; i < columns; ++i) {
    const bool known = (above[i] != 0) & (here[i] != 0) & (below[i] != 0);
    bend[i] += known ? above[i] - 2 * here[i] + below[i] : 0.0F;
  }
}

PALPATE_HOT_LOOP void raise_row(const float* bend, const float* re, const float* im, long columns,
                                float* __restrict sigma) {
  for (long i = 0; i < columns; ++i) {
    const float relative = bend[i] * bend[i] / (re[i] * re[i] + im[i] * im[i]);
    const float variance = kVariance * (relative - kUsual * kUsual);
    sigma[i] = variance > sigma[i] * sigma[i] ? std::sqrt(variance) : sigma[i];
  }
}

}  // namespace

void add_texture_error(const std::vector<Demodulated>& channels, const Combined& sum,
                       const DemodulationFilter& filter, Plane& sigma) {
  const long period = std::lround(filter.period());
  const long columns = sigma.cols();
  Eigen::ArrayXf bend(columns);
  for (long row = period; row + period < sigma.rows(); ++row) {
    bend.setZero();
    for (const Demodulated& channel : channels) {
      add_bend(&channel.mean(row - period, 0), &channel.mean(row, 0),
               &channel.mean(row + period, 0), columns, bend.data());
    }
    raise_row(bend.data(), &sum.re(row, 0), &sum.im(row, 0), columns, &sigma(row, 0));
  }
}

}  // namespace palpate::sensing
