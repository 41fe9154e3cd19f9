// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/demodulation.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "image/hot_loop.h"
#include "phase/local_frequency.h"
#include "phase/row_average.h"
#include "phase/window_fit.h"

namespace palpate::sensing {
namespace {
PALPATE_HOT_LOOP void change_counts(const std::uint8_t* entering, const std::uint8_t* leaving,
                                    int* __restrict count, long columns) {
  for (long i = 0; i < columns; ++i) count[i] += entering[i] - leaving[i];
}

/// For each pixel, the number of mask pixels in its window; pixels beyond the image do not count.
class WindowCount {
 public:
  WindowCount(const Mask& mask, int radius)
      : mask_(mask),
        radius_(radius),
        nothing_(static_cast<std::size_t>(mask.cols()), 0),
        count_(static_cast<std::size_t>(mask.cols()), 0) {
    for (long row = 0; row < std::min<long>(radius, mask.rows()); ++row) move(row, -1);
  }
  /// Must be called for rows 0, 1, 2, ... in this order.
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

/// Method for fitting the windows of some columns; the most general one that any of them needs.
enum class FitMethod : std::uint8_t { nothing, whole, cut };

/// Number of columns that are fitted with the same method.
constexpr long kGroup = 16;

PALPATE_HOT_LOOP void choose_fits(const std::uint8_t* mask, const int* count, int whole_count,
                                  long columns, FitMethod* fits) {
  for (long start = 0; start < columns; start += kGroup) {
    const long end = start + kGroup < columns ? start + kGroup : columns;
    int lit = 0;
    int cut = 0;
    for (long i = start; i < end; ++i) {
      lit |= mask[i];
      cut |= count[i] - whole_count;
    }
    fits[start / kGroup] =
        lit == 0 ? FitMethod::nothing : (cut == 0 ? FitMethod::whole : FitMethod::cut);
  }
}

/// Results of one row, before averaging along it.
class UnsmoothedRow {
 public:
  UnsmoothedRow(std::size_t channels, long columns)
      : values_(static_cast<long>(2 * channels) + 1, columns) {}
  /// The memory to which the fits write; the mean needs no averaging.
  FittedRow row(long row, Demodulation& out) {
    FittedRow fitted;
    fitted.residual = &values_(values_.rows() - 1, 0);
    fitted.count = out.channels.size();
    for (std::size_t i = 0; i < out.channels.size(); ++i) {
      const auto first = static_cast<long>(2 * i);
      fitted.channels[i] = {&out.channels[i].mean(row, 0), &values_(first, 0),
                            &values_(first + 1, 0)};
    }
    return fitted;
  }
  static void smooth(const FittedRow& fitted, long row, int averages, Demodulation& out) {
    const long columns = out.residual.cols();
    average_row(fitted.residual, averages, &out.residual(row, 0), columns);
    for (std::size_t i = 0; i < out.channels.size(); ++i) {
      average_row(fitted.channels[i].re, averages, &out.channels[i].re(row, 0), columns);
      average_row(fitted.channels[i].im, averages, &out.channels[i].im(row, 0), columns);
    }
  }

 private:
  Plane values_;
};

void resize(std::size_t channels, const Mask& mask, Demodulation& out) {
  out.channels.resize(channels);
  out.residual.resize(mask.rows(), mask.cols());
  for (Demodulated& signal : out.channels) {
    for (Plane* plane : {&signal.mean, &signal.re, &signal.im})
      plane->resize(mask.rows(), mask.cols());
  }
}

}  // namespace

double DemodulationFilter::window_variance() const {
  double variance = 0;
  for (std::size_t k = 1; k < weight.size(); ++k)
    variance += 2 * static_cast<double>(weight[k]) * static_cast<double>(k * k);
  return variance;
}

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
  DemodulationFilter wider = filter;
  for (++wider.averages; wider.width() <= filter.period(); ++wider.averages)
    filter.averages = wider.averages;
  return filter;
}

void demodulate(const std::vector<Plane>& channels, const Mask& mask,
                const DemodulationFilter& filter, Demodulation& out) {
  resize(channels.size(), mask, out);
  const long columns = mask.cols();
  const Window window(filter);
  WindowCount counts(mask, filter.radius);
  PowerRows power(channels, filter.radius);
  UnsmoothedRow unsmoothed(channels.size(), columns);
  std::vector<FitMethod> fits(static_cast<std::size_t>((columns + kGroup - 1) / kGroup));
  LocalFrequency frequency(filter);
  const int reach = frequency.reach();
  const int whole_count = 2 * filter.radius + 1;
  for (long row = 0; row < mask.rows(); ++row) {
    choose_fits(&mask(row, 0), counts.row(row).data(), whole_count, columns, fits.data());
    power.reach(row + filter.radius);
    const std::complex<double> phase = std::polar(1.0, filter.carrier * static_cast<double>(row));
    const Turn turn{static_cast<float>(phase.real()), static_cast<float>(phase.imag())};
    const FittedRow fitted = unsmoothed.row(row, out);
    for (auto first = fits.begin(); first != fits.end();) {
      const auto last =
          std::find_if(first, fits.end(), [&](FitMethod fit) { return fit != *first; });
      const long column = kGroup * (first - fits.begin());
      const Block block{row, column, std::min(kGroup * (last - fits.begin()), columns) - column};
      switch (*first) {
        case FitMethod::nothing:
          fit_nothing(block, fitted);
          break;
        case FitMethod::whole:
          fit_whole_windows(channels, power, window, block, turn, fitted);
          break;
        case FitMethod::cut:
          fit_cut_windows(channels, power, mask, window, block, turn, fitted);
          break;
      }
      first = last;
    }
    UnsmoothedRow::smooth(fitted, row, filter.averages, out);
    if (row >= 2 * reach) frequency.adapt(row - reach, out);
  }
}

}  // namespace palpate::sensing
