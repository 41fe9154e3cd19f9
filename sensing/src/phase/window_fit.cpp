// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/window_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

/// At a border, a sinusoid and a mean can be separated only if the window still contains enough of
/// a period: the smallest pivot of the normal equations, which is 1/2 in a whole window, must
/// exceed this.
constexpr double kLeastPivot = 0.05;

/// The window must also keep this share of its weight. With less, the pixel is so far from the
/// middle of the remaining part that a slope of the brightness or of the phase changes the phase.
constexpr double kLeastWeight = 0.75;

/// Eight columns at once: one register of processors with AVX2. GCC 12 splits larger vectors into
/// pieces that it moves to memory and back.
constexpr long kLanes = 8;
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));
using MaskLanes = std::uint8_t __attribute__((vector_size(kLanes)));

// The functions below work on kLanes columns or on one: T is Lanes or float.

template <typename T>
[[gnu::always_inline]] inline void load(const float* from, T& to) {
  std::memcpy(&to, from, sizeof to);
}
template <typename T>
[[gnu::always_inline]] inline void store(const T& from, float* to) {
  std::memcpy(to, &from, sizeof from);
}
[[gnu::always_inline]] inline void load_mask(const std::uint8_t* from, Lanes& to) {
  MaskLanes bytes;
  std::memcpy(&bytes, from, sizeof bytes);
  to = __builtin_convertvector(bytes, Lanes);
}
[[gnu::always_inline]] inline void load_mask(const std::uint8_t* from, float& to) { to = *from; }

/// Calls `fit(column, T{})` for all columns.
template <typename Fit>
[[gnu::always_inline]] inline void for_each_column(long columns, const Fit& fit) {
  long i = 0;
  for (; i + kLanes <= columns; i += kLanes) fit(i, Lanes{});
  for (; i < columns; ++i) fit(i, 0.0F);
}

/// Half amplitudes, with the carrier removed.
template <typename T>
[[gnu::always_inline]] inline void store_turned(const T& amplitude, const T& quadrature, Turn turn,
                                                const T& half, float* re, float* im) {
  store<T>(half * (amplitude * turn.cosine + quadrature * turn.sine), re);
  store<T>(half * (quadrature * turn.cosine - amplitude * turn.sine), im);
}

/// Fits the windows around the pixels of one row of a channel, and subtracts from the residual the
/// part that mean and sinusoid explain.
PALPATE_HOT_LOOP void fit_whole_row(const float* center, long stride, const Tap* pairs, int radius,
                                    WholeWindow whole, Turn turn, long columns,
                                    FittedRow::Channel out, float* residual) {
  for_each_column(
      columns, [&](long i, auto zero) __attribute__((always_inline)) {
        using T = decltype(zero);
        T mean = zero, re = zero, im = zero;
        for (int k = 0; k <= radius; ++k) {
          T above, below;
          load(center + i - k * stride, above);
          load(center + i + k * stride, below);
          const T sum = above + below;
          mean += pairs[k].weight * sum;
          re += pairs[k].cosine * sum;
          im += pairs[k].sine * (above - below);
        }
        const T amplitude = whole.cosine_scale * (re - whole.cosine * mean);
        const T quadrature = whole.sine_scale * im;
        const T level = mean - whole.cosine * amplitude;
        T left;
        load(residual + i, left);
        store<T>(left - (level * mean + amplitude * re + quadrature * im), residual + i);
        store(level, out.mean + i);
        store_turned<T>(amplitude, quadrature, turn, zero + 0.5F, out.re + i, out.im + i);
      });
}

/// The normal equations of a window that is cut by the mask, for the basis 1, cos, -sin, divided by
/// the remaining weight, and solved by elimination of the mean.
template <typename T>
struct CutWindow {
  T scale;  ///< 1 / remaining weight
  T cosine, sine;
  T p, q, r;     ///< p r / r q, without the mean
  T inverse;     ///< of their determinant; zero where the fit is not determined
  T determined;  ///< 1 or 0
  T half;        ///< 1/2; zero if the remaining weight is too small
};

/// The rows of a column that a cut window reaches.
struct CutRows {
  const std::uint8_t* mask;
  long stride;
  const Tap* taps;
  int count;
  int center;  ///< number of the row of the pixel itself
};

template <typename T>
[[gnu::always_inline]] inline void find_cut_window(const CutRows& rows, long i,
                                                   CutWindow<T>& window) {
  constexpr auto least_pivot = static_cast<float>(kLeastPivot);
  constexpr auto least_weight = static_cast<float>(kLeastWeight);
  T total{}, cosine{}, sine{}, cosine2{}, cosine_sine{}, inside;
  for (int k = 0; k < rows.count; ++k) {
    const Tap& tap = rows.taps[k];
    load_mask(rows.mask + i + k * rows.stride, inside);
    total += tap.weight * inside;
    cosine += tap.cosine * inside;
    sine -= tap.sine * inside;
    cosine2 += tap.cosine2 * inside;
    cosine_sine -= tap.cosine_sine * inside;
  }
  load_mask(rows.mask + i + rows.center * rows.stride, inside);
  const T zero{};
  const T one = zero + 1.0F;
  window.scale = total > 0.0F ? one / total : zero;
  window.cosine = window.scale * cosine;
  window.sine = window.scale * sine;
  const T cc = window.scale * cosine2;
  window.p = cc - window.cosine * window.cosine;
  window.q = 1.0F - cc - window.sine * window.sine;
  window.r = window.scale * cosine_sine - window.cosine * window.sine;
  const T determinant = window.p * window.q - window.r * window.r;
  const T larger = window.p > window.q ? window.p : window.q;
  const auto determined = (inside > 0.0F) & (total > 0.0F) & (determinant > least_pivot * larger);
  window.determined = determined ? one : zero;
  window.inverse = determined ? one / determinant : zero;
  window.half = total >= least_weight ? 0.5F * one : zero;
}

/// The same as `fit_whole_row` for windows of which some are cut; zeros where the fit is not
/// determined and outside the mask.
PALPATE_HOT_LOOP void fit_cut_row(const CutRows& rows, const float* const* channels,
                                  const FittedRow::Channel* out, std::size_t count, Turn turn,
                                  long columns, float* residual) {
  for_each_column(
      columns, [&](long i, auto zero) __attribute__((always_inline)) {
        using T = decltype(zero);
        CutWindow<T> window;
        find_cut_window(rows, i, window);
        T left;
        load(residual + i, left);
        for (std::size_t channel = 0; channel < count; ++channel) {
          T mean = zero, re = zero, im = zero;
          for (int k = 0; k < rows.count; ++k) {
            T value, inside;
            load(channels[channel] + i + k * rows.stride, value);
            load_mask(rows.mask + i + k * rows.stride, inside);
            value *= inside;
            mean += rows.taps[k].weight * value;
            re += rows.taps[k].cosine * value;
            im -= rows.taps[k].sine * value;
          }
          const T value = window.scale * mean;
          const T first = window.scale * re - window.cosine * value;
          const T second = window.scale * im - window.sine * value;
          const T amplitude = window.inverse * (window.q * first - window.r * second);
          const T quadrature = window.inverse * (window.p * second - window.r * first);
          const T level =
              window.determined * (value - window.cosine * amplitude - window.sine * quadrature);
          left -= level * mean + amplitude * re + quadrature * im;
          store(level, out[channel].mean + i);
          store_turned<T>(amplitude, quadrature, turn, window.half, out[channel].re + i,
                          out[channel].im + i);
        }
        T inside;
        load_mask(rows.mask + i + rows.center * rows.stride, inside);
        store<T>(inside * window.scale * left, residual + i);
      });
}

PALPATE_HOT_LOOP void add_power(const float* above, const float* below, float weight, long columns,
                                float* __restrict sum) {
  for (long i = 0; i < columns; ++i) sum[i] += weight * (above[i] + below[i]);
}

PALPATE_HOT_LOOP void add_masked_power(const float* power, const std::uint8_t* mask, float weight,
                                       long columns, float* __restrict sum) {
  for (long i = 0; i < columns; ++i) sum[i] += mask[i] != 0 ? weight * power[i] : 0.0F;
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
    taps.push_back({.weight = static_cast<float>(w),
                    .cosine = static_cast<float>(w * c),
                    .sine = static_cast<float>(w * s),
                    .cosine2 = static_cast<float>(w * c * c),
                    .cosine_sine = static_cast<float>(w * c * s)});
    sum += w * c;
    cosines += w * c * c;
    sines += w * s * s;
  }
  whole = {static_cast<float>(sum), static_cast<float>(1 / (cosines - sum * sum)),
           static_cast<float>(1 / sines)};
  pairs.assign(taps.begin() + radius, taps.end());
  pairs[0].weight /= 2;
  pairs[0].cosine /= 2;
  pairs[0].sine /= 2;
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
                       const Window& window, const Block& block, Turn turn, const FittedRow& out) {
  float* residual = out.residual + block.column;
  std::fill_n(residual, block.columns, 0.0F);
  for (int k = 0; k <= window.radius; ++k) {
    add_power(power.at(block.row - k, block.column), power.at(block.row + k, block.column),
              window.pairs[static_cast<std::size_t>(k)].weight, block.columns, residual);
  }
  for (std::size_t i = 0; i < channels.size(); ++i) {
    fit_whole_row(&channels[i](block.row, block.column), channels[i].cols(), window.pairs.data(),
                  window.radius, window.whole, turn, block.columns,
                  out.channels[i].from(block.column), residual);
  }
}

void fit_cut_windows(const std::vector<Plane>& channels, const PowerRows& power, const Mask& mask,
                     const Window& window, const Block& block, Turn turn, const FittedRow& out) {
  const long first = std::max<long>(0, block.row - window.radius);
  const long last = std::min<long>(mask.rows() - 1, block.row + window.radius);
  const Tap* taps = &window.taps[static_cast<std::size_t>(first - block.row + window.radius)];
  float* residual = out.residual + block.column;
  std::fill_n(residual, block.columns, 0.0F);
  for (long row = first; row <= last; ++row) {
    add_masked_power(power.at(row, block.column), &mask(row, block.column),
                     taps[row - first].weight, block.columns, residual);
  }
  const CutRows rows{.mask = &mask(first, block.column),
                     .stride = mask.cols(),
                     .taps = taps,
                     .count = static_cast<int>(last - first + 1),
                     .center = static_cast<int>(block.row - first)};
  std::array<const float*, kMostChannels> values{};
  std::array<FittedRow::Channel, kMostChannels> fitted;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    values[i] = &channels[i](first, block.column);
    fitted[i] = out.channels[i].from(block.column);
  }
  fit_cut_row(rows, values.data(), fitted.data(), channels.size(), turn, block.columns, residual);
}

void fit_nothing(const Block& block, const FittedRow& out) {
  std::fill_n(out.residual + block.column, block.columns, 0.0F);
  for (std::size_t i = 0; i < out.count; ++i) {
    const FittedRow::Channel& channel = out.channels[i];
    for (float* values : {channel.mean, channel.re, channel.im})
      std::fill_n(values + block.column, block.columns, 0.0F);
  }
}

}  // namespace palpate::sensing
