// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "window_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "hot_loop.h"

namespace palpate::sensing {
namespace {

/// At a border a sinusoid and a mean are told apart only if the window still holds enough of a
/// period: the smallest pivot of the normal equations, which is 1/2 in a whole window, must exceed
/// this.
constexpr double kLeastPivot = 0.05;

/// And so much of the window's weight: where less is left, the pixel lies so far off the middle of
/// what is that a slope of the brightness or of the phase passes for a phase.
constexpr double kLeastWeight = 0.85;

/// One row of sums over the window, for the columns of a block.
using BlockRow = std::array<float, kBlock>;

/// Adds the pixels k rows above and below, for two k at once: even and odd part of the window.
PALPATE_HOT_LOOP void add_rows(const float* above, const float* below, Tap near,
                               const float* far_above, const float* far_below, Tap far,
                               long columns, float* __restrict mean, float* __restrict re,
                               float* __restrict im) {
  for (long i = 0; i < columns; ++i) {
    const float sum = above[i] + below[i];
    const float difference = below[i] - above[i];
    const float far_sum = far_above[i] + far_below[i];
    const float far_difference = far_below[i] - far_above[i];
    mean[i] += near.weight * sum + far.weight * far_sum;
    re[i] += near.cosine * sum + far.cosine * far_sum;
    im[i] -= near.sine * difference + far.sine * far_difference;
  }
}

/// Adds one row, as far as it lies in the mask.
PALPATE_HOT_LOOP void add_masked_row(const float* values, const std::uint8_t* mask, long columns,
                                     Tap tap, float* __restrict mean, float* __restrict re,
                                     float* __restrict im) {
  for (long i = 0; i < columns; ++i) {
    const float value = mask[i] != 0 ? values[i] : 0.0F;
    mean[i] += tap.weight * value;
    re[i] += tap.cosine * value;
    im[i] -= tap.sine * value;
  }
}

/// Sums over whole windows to mean and half amplitudes, the carrier taken out; takes from the
/// residual what they explain.
PALPATE_HOT_LOOP void solve_row(float* __restrict mean, float* __restrict re, float* __restrict im,
                                float* __restrict residual, long columns, WholeWindow whole,
                                Turn turn) {
  for (long i = 0; i < columns; ++i) {
    const float amplitude = whole.cosine_scale * (re[i] - whole.cosine * mean[i]);
    const float quadrature = whole.sine_scale * im[i];
    const float level = mean[i] - whole.cosine * amplitude;
    residual[i] -= level * mean[i] + amplitude * re[i] + quadrature * im[i];
    mean[i] = level;
    re[i] = 0.5F * (amplitude * turn.cosine + quadrature * turn.sine);
    im[i] = 0.5F * (quadrature * turn.cosine - amplitude * turn.sine);
  }
}

/// The normal equations of windows that the mask cuts, for the basis 1, cos, -sin: sums over the
/// pixels of the mask.
struct CutWindows {
  BlockRow total;        ///< of the weight
  BlockRow cosine;       ///< of weight * cos
  BlockRow sine;         ///< of -weight * sin
  BlockRow cosine2;      ///< of weight * cos^2
  BlockRow cosine_sine;  ///< of -weight * cos * sin
};

PALPATE_HOT_LOOP void add_mask(const std::uint8_t* mask, long columns, Tap tap,
                               CutWindows& __restrict sums) {
  const float cosine2 = tap.weight > 0 ? tap.cosine * tap.cosine / tap.weight : 0.0F;
  const float cosine_sine = tap.weight > 0 ? tap.cosine * tap.sine / tap.weight : 0.0F;
  for (long i = 0; i < columns; ++i) {
    const float inside = mask[i] != 0 ? 1.0F : 0.0F;
    sums.total[i] += inside * tap.weight;
    sums.cosine[i] += inside * tap.cosine;
    sums.sine[i] -= inside * tap.sine;
    sums.cosine2[i] += inside * cosine2;
    sums.cosine_sine[i] -= inside * cosine_sine;
  }
}

/// Sums over cut windows to mean and half amplitudes, the carrier taken out; zeros where the fit is
/// not determined and outside the mask.
PALPATE_HOT_LOOP void solve_cut_row(const CutWindows& sums, const std::uint8_t* mask, long columns,
                                    Turn turn, float* __restrict mean, float* __restrict re,
                                    float* __restrict im, float* __restrict residual) {
  constexpr auto least_pivot = static_cast<float>(kLeastPivot);
  constexpr auto least_weight = static_cast<float>(kLeastWeight);
  for (long i = 0; i < columns; ++i) {
    const float scale = sums.total[i] > 0 ? 1 / sums.total[i] : 0.0F;
    const float c = scale * sums.cosine[i];
    const float s = scale * sums.sine[i];
    const float cc = scale * sums.cosine2[i];
    const float ss = 1 - cc;
    // The mean eliminated; what is left is symmetric of order two.
    const float p = cc - c * c;
    const float q = ss - s * s;
    const float r = scale * sums.cosine_sine[i] - c * s;
    const float determinant = p * q - r * r;
    const bool determined =
        mask[i] != 0 && sums.total[i] > 0 && determinant > least_pivot * (p > q ? p : q);
    const float inverse = determined ? 1 / determinant : 0.0F;
    const float value = scale * mean[i];
    const float first = scale * re[i] - c * value;
    const float second = scale * im[i] - s * value;
    const float amplitude = inverse * (q * first - r * second);
    const float quadrature = inverse * (p * second - r * first);
    const float level = determined ? value - c * amplitude - s * quadrature : 0.0F;
    residual[i] -= level * mean[i] + amplitude * re[i] + quadrature * im[i];
    mean[i] = level;
    const float half = sums.total[i] >= least_weight ? 0.5F : 0.0F;
    re[i] = half * (amplitude * turn.cosine + quadrature * turn.sine);
    im[i] = half * (quadrature * turn.cosine - amplitude * turn.sine);
  }
}

PALPATE_HOT_LOOP void add_power(const float* above, const float* below, float weight, long columns,
                                float* __restrict sum) {
  for (long i = 0; i < columns; ++i) sum[i] += weight * (above[i] + below[i]);
}

PALPATE_HOT_LOOP void add_masked_power(const float* power, const std::uint8_t* mask, float weight,
                                       long columns, float* __restrict sum) {
  for (long i = 0; i < columns; ++i) sum[i] += mask[i] != 0 ? weight * power[i] : 0.0F;
}

PALPATE_HOT_LOOP void normalize(const float* total, const std::uint8_t* mask, long columns,
                                float* __restrict sum) {
  for (long i = 0; i < columns; ++i) sum[i] = mask[i] != 0 ? sum[i] / total[i] : 0.0F;
}

PALPATE_HOT_LOOP void add_square(const float* values, long columns, float* __restrict sum) {
  for (long i = 0; i < columns; ++i) sum[i] += values[i] * values[i];
}

}  // namespace

Window::Window(const DemodulationFilter& filter) : radius(filter.radius) {
  double cosines = 0;
  double sines = 0;
  double sum = 0;
  for (int k = -radius; k <= radius; ++k) {
    const auto w = static_cast<double>(filter.weight[static_cast<std::size_t>(std::abs(k))]);
    const double c = std::cos(filter.carrier * k);
    const double s = std::sin(filter.carrier * k);
    taps.push_back({static_cast<float>(w), static_cast<float>(w * c), static_cast<float>(w * s)});
    sum += w * c;
    cosines += w * c * c;
    sines += w * s * s;
  }
  whole = {static_cast<float>(sum), static_cast<float>(1 / (cosines - sum * sum)),
           static_cast<float>(1 / sines)};
}

Tap Window::pair(int k) const {
  if (k > radius) return {};
  const Tap& tap = taps[static_cast<std::size_t>(radius + k)];
  const float share = k == 0 ? 0.5F : 1.0F;
  return {share * tap.weight, share * tap.cosine, share * tap.sine};
}

PowerRows::PowerRows(const std::vector<Plane>& channels, int radius)
    : channels_(channels), rows_(2 * radius + 1, channels[0].cols()) {}

void PowerRows::reach(long row) {
  for (; next_ <= std::min(row, channels_[0].rows() - 1); ++next_) {
    float* power = &rows_(next_ % rows_.rows(), 0);
    std::fill_n(power, rows_.cols(), 0.0F);
    for (const Plane& channel : channels_) add_square(&channel(next_, 0), rows_.cols(), power);
  }
}

void fit_whole_windows(const std::vector<Plane>& channels, const PowerRows& power,
                       const Window& window, const Block& block, Turn turn, Demodulation& out) {
  float* residual = &out.residual(block.row, block.column);
  for (int k = 0; k <= window.radius; ++k) {
    add_power(power.at(block.row - k, block.column), power.at(block.row + k, block.column),
              window.pair(k).weight, block.columns, residual);
  }
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const Plane& channel = channels[i];
    Demodulated& signal = out.channels[i];
    float* mean = &signal.mean(block.row, block.column);
    float* re = &signal.re(block.row, block.column);
    float* im = &signal.im(block.row, block.column);
    for (int k = 0; k <= window.radius; k += 2) {
      const int far = std::min(k + 1, window.radius);  // of weight zero if there is none
      add_rows(&channel(block.row - k, block.column), &channel(block.row + k, block.column),
               window.pair(k), &channel(block.row - far, block.column),
               &channel(block.row + far, block.column), window.pair(k + 1), block.columns, mean, re,
               im);
    }
    solve_row(mean, re, im, residual, block.columns, window.whole, turn);
  }
}

void fit_cut_windows(const std::vector<Plane>& channels, const PowerRows& power, const Mask& mask,
                     const Window& window, const Block& block, Turn turn, Demodulation& out) {
  const long first = std::max<long>(0, block.row - window.radius);
  const long last = std::min<long>(mask.rows() - 1, block.row + window.radius);
  float* residual = &out.residual(block.row, block.column);
  CutWindows sums{};
  for (long row = first; row <= last; ++row) {
    const Tap& tap = window.taps[static_cast<std::size_t>(row - block.row + window.radius)];
    const std::uint8_t* inside = &mask(row, block.column);
    add_mask(inside, block.columns, tap, sums);
    add_masked_power(power.at(row, block.column), inside, tap.weight, block.columns, residual);
    for (std::size_t i = 0; i < channels.size(); ++i) {
      Demodulated& signal = out.channels[i];
      add_masked_row(&channels[i](row, block.column), inside, block.columns, tap,
                     &signal.mean(block.row, block.column), &signal.re(block.row, block.column),
                     &signal.im(block.row, block.column));
    }
  }
  const std::uint8_t* inside = &mask(block.row, block.column);
  for (Demodulated& signal : out.channels) {
    solve_cut_row(sums, inside, block.columns, turn, &signal.mean(block.row, block.column),
                  &signal.re(block.row, block.column), &signal.im(block.row, block.column),
                  residual);
  }
  normalize(sums.total.data(), inside, block.columns, residual);
}

}  // namespace palpate::sensing
