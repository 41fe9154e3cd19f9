// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "demodulation.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "hot_loop.h"
#include "local_frequency.h"
#include "window_fit.h"

namespace palpate::sensing {
namespace {
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

/// Binomial weights over five pixels of a row; the outermost two stay.
void smooth_row(float* values, long columns, std::vector<float>& before) {
  before.assign(values, values + columns);
  average_five(before.data(), values, columns);
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

void clear(std::size_t channels, const Mask& mask, Demodulation& out) {
  out.channels.resize(channels);
  out.residual.setZero(mask.rows(), mask.cols());
  for (Demodulated& signal : out.channels) {
    for (Plane* plane : {&signal.mean, &signal.re, &signal.im})
      plane->setZero(mask.rows(), mask.cols());
  }
}

}  // namespace

DemodulationFilter make_filter(double carrier, double periods) {
  const double half_length = periods * std::numbers::pi / std::abs(carrier);
  DemodulationFilter filter{
      .radius = static_cast<int>(std::floor(half_length)), .carrier = carrier, .weight = {}};
  double total = 0;
  std::vector<double> weights;
  for (int k = 0; k <= filter.radius; ++k) {
    weights.push_back(0.5 + 0.5 * std::cos(std::numbers::pi * k / half_length));
    total += (k == 0 ? 1 : 2) * weights.back();
  }
  for (const double weight : weights) filter.weight.push_back(static_cast<float>(weight / total));
  return filter;
}

void demodulate(const std::vector<Plane>& channels, const Mask& mask,
                const DemodulationFilter& filter, Demodulation& out) {
  clear(channels.size(), mask, out);
  const Window window(filter);
  WindowCount counts(mask, filter.radius);
  PowerRows power(channels, filter.radius);
  std::vector<float> unsmoothed;
  LocalFrequency frequency(filter);
  const int reach = frequency.reach();
  const int whole_count = 2 * filter.radius + 1;
  for (long row = 0; row < mask.rows(); ++row) {
    const std::vector<int>& count = counts.row(row);
    power.reach(row + filter.radius);
    const std::complex<double> phase = std::polar(1.0, filter.carrier * static_cast<double>(row));
    const Turn turn{static_cast<float>(phase.real()), static_cast<float>(phase.imag())};
    for (long column = 0; column < mask.cols(); column += kBlock) {
      const Block block{row, column, std::min(kBlock, mask.cols() - column)};
      const Content windows = content(&mask(row, column), &count[static_cast<std::size_t>(column)],
                                      block.columns, whole_count);
      if (windows.whole) {
        fit_whole_windows(channels, power, window, block, turn, out);
      } else if (windows.lit) {
        fit_cut_windows(channels, power, mask, window, block, turn, out);
      }
    }
    smooth_row(&out.residual(row, 0), mask.cols(), unsmoothed);
    for (Demodulated& signal : out.channels) {
      smooth_row(&signal.re(row, 0), mask.cols(), unsmoothed);
      smooth_row(&signal.im(row, 0), mask.cols(), unsmoothed);
    }
    if (row >= 2 * reach) frequency.adapt(row - reach, out);
  }
}

}  // namespace palpate::sensing
