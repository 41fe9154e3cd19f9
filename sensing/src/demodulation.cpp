// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "demodulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

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

/// So many columns are worked on at a time: their sums stay in the first-level cache, and a block
/// without light, or without a border, is passed over quickly.
constexpr long kBlock = 128;

/// One row of sums over the window, for the columns of a block.
using BlockRow = std::array<float, kBlock>;

/// What a row at some distance counts: weight, and weight times cos and sin of the carrier.
struct Tap {
  float weight = 0;
  float cosine = 0;
  float sine = 0;
};

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

/// The normal equations of a whole window: its symmetry leaves the sine alone.
struct WholeWindow {
  float cosine = 0;        ///< sum of weight * cos
  float cosine_scale = 0;  ///< 1 / (sum of weight * cos^2 - cosine^2)
  float sine_scale = 0;    ///< 1 / sum of weight * sin^2
};

/// Cosine and sine of the carrier at a row.
struct Turn {
  float cosine = 1;
  float sine = 0;
};

/// Sums over whole windows to mean and half amplitudes, the carrier taken out.
PALPATE_HOT_LOOP void solve_row(float* __restrict mean, float* __restrict re, float* __restrict im,
                                long columns, WholeWindow whole, Turn turn) {
  for (long i = 0; i < columns; ++i) {
    const float amplitude = whole.cosine_scale * (re[i] - whole.cosine * mean[i]);
    const float quadrature = whole.sine_scale * im[i];
    mean[i] -= whole.cosine * amplitude;
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
                                    float* __restrict im) {
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
    mean[i] = determined ? value - c * amplitude - s * quadrature : 0.0F;
    const float half = sums.total[i] >= least_weight ? 0.5F : 0.0F;
    re[i] = half * (amplitude * turn.cosine + quadrature * turn.sine);
    im[i] = half * (quadrature * turn.cosine - amplitude * turn.sine);
  }
}

PALPATE_HOT_LOOP void average_five(const float* in, float* __restrict out, long columns) {
  for (long i = 2; i + 2 < columns; ++i) {
    out[i] = (in[i - 2] + in[i + 2] + 4 * (in[i - 1] + in[i + 1]) + 6 * in[i]) / 16;
  }
}

PALPATE_HOT_LOOP void change_counts(const std::uint8_t* entering, const std::uint8_t* leaving,
                                    int* __restrict count, long columns) {
  for (long i = 0; i < columns; ++i) count[i] += entering[i] - leaving[i];
}

/// For each pixel: how many pixels of the mask its window holds, image borders counting as outside.
class WindowCount {
 public:
  WindowCount(const Mask& mask, int radius)
      : mask_(mask),
        radius_(radius),
        nothing_(static_cast<std::size_t>(mask.cols()), 0),
        count_(static_cast<std::size_t>(mask.cols()), 0) {
    for (long row = 0; row < std::min<long>(radius, mask.rows()); ++row) move(row, -1);
  }
  /// To be called for rows 0, 1, 2, ... in turn.
  const std::vector<int>& row(long row) {
    move(row + radius_, row - radius_ - 1);
    return count_;
  }

 private:
  [[nodiscard]] const std::uint8_t* mask_row(long row) const {
    return row >= 0 && row < mask_.rows() ? &mask_(row, 0) : nothing_.data();
  }
  void move(long entering, long leaving) {
    change_counts(mask_row(entering), mask_row(leaving), count_.data(), mask_.cols());
  }
  const Mask& mask_;
  long radius_;
  std::vector<std::uint8_t> nothing_;
  std::vector<int> count_;
};

/// The rows k = -radius ... radius of the window, and its normal equations.
struct Window {
  explicit Window(const DemodulationFilter& filter) : radius(filter.radius) {
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
  /// The rows k above and below, each counted once.
  [[nodiscard]] Tap pair(int k) const {
    if (k > radius) return {};
    const Tap& tap = taps[static_cast<std::size_t>(radius + k)];
    const float share = k == 0 ? 0.5F : 1.0F;
    return {share * tap.weight, share * tap.cosine, share * tap.sine};
  }
  int radius;
  std::vector<Tap> taps;
  WholeWindow whole;
};

/// Some columns of one row.
struct Block {
  long row = 0;
  long column = 0;
  long columns = 0;
};

/// Binomial weights over five pixels of a row; the outermost two stay.
void smooth_row(float* values, long columns, std::vector<float>& before) {
  before.assign(values, values + columns);
  average_five(before.data(), values, columns);
}

void clear(const Block& block, Demodulated& out) {
  for (Plane* plane : {&out.mean, &out.re, &out.im})
    std::fill_n(&(*plane)(block.row, block.column), block.columns, 0.0F);
}

/// Windows that lie wholly in the mask: plain convolution.
void fit_whole_windows(const Plane& channel, const Window& window, const Block& block, Turn turn,
                       Demodulated& out) {
  float* mean = &out.mean(block.row, block.column);
  float* re = &out.re(block.row, block.column);
  float* im = &out.im(block.row, block.column);
  for (int k = 0; k <= window.radius; k += 2) {
    const int far = std::min(k + 1, window.radius);  // of weight zero if there is none
    add_rows(&channel(block.row - k, block.column), &channel(block.row + k, block.column),
             window.pair(k), &channel(block.row - far, block.column),
             &channel(block.row + far, block.column), window.pair(k + 1), block.columns, mean, re,
             im);
  }
  solve_row(mean, re, im, block.columns, window.whole, turn);
}

/// Windows of which some are cut by the mask.
void fit_cut_windows(const std::vector<Plane>& channels, const Mask& mask, const Window& window,
                     const Block& block, Turn turn, std::vector<Demodulated>& out) {
  const long first = std::max<long>(0, block.row - window.radius);
  const long last = std::min<long>(mask.rows() - 1, block.row + window.radius);
  CutWindows sums{};
  for (long row = first; row <= last; ++row) {
    const Tap& tap = window.taps[static_cast<std::size_t>(row - block.row + window.radius)];
    const std::uint8_t* inside = &mask(row, block.column);
    add_mask(inside, block.columns, tap, sums);
    for (std::size_t i = 0; i < channels.size(); ++i) {
      add_masked_row(&channels[i](row, block.column), inside, block.columns, tap,
                     &out[i].mean(block.row, block.column), &out[i].re(block.row, block.column),
                     &out[i].im(block.row, block.column));
    }
  }
  for (Demodulated& signal : out) {
    solve_cut_row(sums, &mask(block.row, block.column), block.columns, turn,
                  &signal.mean(block.row, block.column), &signal.re(block.row, block.column),
                  &signal.im(block.row, block.column));
  }
}

/// What windows of a block look like.
struct Content {
  bool lit = false;    ///< some pixel is in the mask
  bool whole = false;  ///< all pixels are, with all of their windows
};
Content content(const std::uint8_t* mask, const int* count, long columns, int whole_count) {
  int lit = 0;
  int least = whole_count;
  for (long i = 0; i < columns; ++i) {
    lit |= mask[i];
    least = std::min(least, count[i]);
  }
  return {lit != 0, least == whole_count};
}

}  // namespace

DemodulationFilter make_filter(double carrier) {
  const double period = 2 * std::numbers::pi / std::abs(carrier);
  DemodulationFilter filter{
      .radius = static_cast<int>(std::floor(period)), .carrier = carrier, .weight = {}};
  double total = 0;
  std::vector<double> weights;
  for (int k = 0; k <= filter.radius; ++k) {
    weights.push_back(0.5 + 0.5 * std::cos(std::numbers::pi * k / period));
    total += (k == 0 ? 1 : 2) * weights.back();
  }
  for (const double weight : weights) filter.weight.push_back(static_cast<float>(weight / total));
  return filter;
}

void demodulate(const std::vector<Plane>& channels, const Mask& mask,
                const DemodulationFilter& filter, std::vector<Demodulated>& out) {
  out.resize(channels.size());
  for (Demodulated& signal : out) {
    for (Plane* plane : {&signal.mean, &signal.re, &signal.im})
      plane->resize(mask.rows(), mask.cols());
  }
  const Window window(filter);
  WindowCount counts(mask, filter.radius);
  std::vector<float> unsmoothed;
  const int whole_count = 2 * filter.radius + 1;
  for (long row = 0; row < mask.rows(); ++row) {
    const std::vector<int>& count = counts.row(row);
    const std::complex<double> phase = std::polar(1.0, filter.carrier * static_cast<double>(row));
    const Turn turn{static_cast<float>(phase.real()), static_cast<float>(phase.imag())};
    for (long column = 0; column < mask.cols(); column += kBlock) {
      const Block block{row, column, std::min(kBlock, mask.cols() - column)};
      for (Demodulated& signal : out) clear(block, signal);
      const Content windows = content(&mask(row, column), &count[static_cast<std::size_t>(column)],
                                      block.columns, whole_count);
      if (windows.whole) {
        for (std::size_t i = 0; i < channels.size(); ++i)
          fit_whole_windows(channels[i], window, block, turn, out[i]);
      } else if (windows.lit) {
        fit_cut_windows(channels, mask, window, block, turn, out);
      }
    }
    for (Demodulated& signal : out) {
      smooth_row(&signal.re(row, 0), mask.cols(), unsmoothed);
      smooth_row(&signal.im(row, 0), mask.cols(), unsmoothed);
    }
  }
}

}  // namespace palpate::sensing
