// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/white_view.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "phase/unmixing.h"
#include "phase/wrapped_phase.h"
#include "regions/unwrapping.h"

namespace palpate::sensing {
namespace {

/// Regions of the phase grow through pixels with at most this variance [rad^2] and steps [rad], as
/// in the decoder.
constexpr FloodLimits kRegionLimits{0.01, 1.5};
/// This share of a cell's pixels must be reliable.
constexpr double kLeastReliableShare = 0.75;

/// Pixels whose neighbours within `rows` and `columns` all belong to the mask; none at the border.
Mask shrunk(const Mask& mask, long rows, long columns) {
  const long height = mask.rows();
  const long width = mask.cols();
  using Counts = Eigen::Array<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Counts sums = Counts::Zero(height + 1, width + 1);  // of all pixels above and to the left
  for (long row = 0; row < height; ++row) {
    for (long column = 0; column < width; ++column) {
      sums(row + 1, column + 1) =
          sums(row, column + 1) + sums(row + 1, column) - sums(row, column) + mask(row, column);
    }
  }
  Mask out = Mask::Zero(height, width);
  const auto whole = static_cast<int>((2 * rows + 1) * (2 * columns + 1));
  for (long row = rows; row + rows < height; ++row) {
    for (long column = columns; column + columns < width; ++column) {
      const long top = row - rows;
      const long bottom = row + rows + 1;
      const long left = column - columns;
      const long right = column + columns + 1;
      const int count =
          sums(bottom, right) - sums(top, right) - sums(bottom, left) + sums(top, left);
      out(row, column) = count == whole ? 1 : 0;
    }
  }
  return out;
}

/// Finds the pixels at which no channel clips.
Mask unsaturated(const std::vector<Plane>& channels) {
  Mask mask = Mask::Ones(channels[0].rows(), channels[0].cols());
  for (const Plane& channel : channels) mask *= (channel < 1).cast<std::uint8_t>();
  return mask;
}

Mask modulated(const Demodulated& signal, const Pattern& pattern,
               const ChromaticCalibrationOptions& options) {
  const Plane amplitude = 2 * (signal.re.square() + signal.im.square()).sqrt();
  const auto contrast = static_cast<float>(options.min_contrast * pattern.amplitude / pattern.mean);
  const auto least = static_cast<float>(options.min_modulation);
  return (amplitude >= least && amplitude >= contrast * signal.mean).cast<std::uint8_t>();
}

Plane wrapped_phase(const Demodulated& signal) {
  Plane phase(signal.re.rows(), signal.re.cols());
  for (long i = 0; i < phase.size(); ++i)
    phase.data()[i] = std::atan2(signal.im.data()[i], signal.re.data()[i]);
  return phase;
}

std::complex<double> at(const Demodulated& signal, long row, long column) {
  return {static_cast<double>(signal.re(row, column)), static_cast<double>(signal.im(row, column))};
}

/// Empty if too few of the cell's pixels are reliable or they belong to several regions.
std::optional<PhaseCell> measure_cell(const WhiteView& view, const Regions& regions, long top,
                                      long left, double carrier) {
  PhaseCell cell{.row = top, .column = left, .region = -1};
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double phase = 0;
  std::complex<double> down = 0;
  std::complex<double> right = 0;
  int count = 0;
  for (long row = top; row < top + view.cell_size; ++row) {
    for (long column = left; column < left + view.cell_size; ++column) {
      if (view.reliable(row, column) == 0) continue;
      const int label = regions.label(row, column);
      if (count > 0 && label != cell.region) return std::nullopt;
      cell.region = label;
      ++count;
      center += Eigen::Vector2d(static_cast<double>(row), static_cast<double>(column));
      phase += static_cast<double>(regions.phase(row, column));
      // Reliable pixels are not at the border, so their neighbours exist.
      down += at(view.green, row + 1, column) * std::conj(at(view.green, row - 1, column));
      right += at(view.green, row, column + 1) * std::conj(at(view.green, row, column - 1));
    }
  }
  if (count < kLeastReliableShare * view.cell_size * view.cell_size) return std::nullopt;
  cell.center = center / count;
  cell.gradient = {0.5 * std::arg(down) + carrier, 0.5 * std::arg(right)};
  cell.phase = phase / count + carrier * cell.center.x();
  return cell;
}

}  // namespace

Eigen::Vector2d camera_pixel(const PhaseCell& cell, const Carrier& carrier) {
  return carrier.transposed ? cell.center : Eigen::Vector2d(cell.center.y(), cell.center.x());
}

WhiteView measure_white_view(const cv::Mat& image, const Carrier& carrier,
                             const Eigen::Matrix3d& mixing, const Pattern& pattern,
                             const ChromaticCalibrationOptions& options) {
  std::vector<Plane> channels;
  split_frame(image, carrier.transposed, channels);
  const DemodulationFilter filter = make_filter(carrier.along);
  Mask lit;
  find_lit(channels,
           {.colored = false, .radius = (filter.radius + 1) / 2, .min_signal = options.min_signal},
           lit);
  Demodulation demodulation;
  demodulate(channels, lit, filter, demodulation);
  unmix(mixing, demodulation.channels);
  std::vector<Demodulated>& signals = demodulation.channels;
  WhiteView view;
  view.cell_size = 2 * filter.radius + 1;
  // Windows and the averages along the rows have this reach.
  const auto away_from_border = [&](const Mask& mask) {
    return shrunk(mask, filter.radius, filter.width() / 2);
  };
  view.reliable = away_from_border(lit * unsaturated(channels));
  for (const Demodulated& signal : signals) view.reliable *= modulated(signal, pattern, options);
  view.green = std::move(signals[0]);
  view.others = {std::move(signals[1]), std::move(signals[2])};

  const Plane wrapped = wrapped_phase(view.green);
  Plane variance;
  phase_variance(wrapped, view.reliable, variance);
  UnwrappingBuffers buffers;
  Regions regions;
  grow_regions(wrapped, variance, kRegionLimits, buffers, regions);
  // A window at a border of its region mixes the phases of both sides.
  view.reliable *= away_from_border((regions.label >= 0).cast<std::uint8_t>());
  view.regions = regions.count;
  for (long top = 0; top + view.cell_size <= view.reliable.rows(); top += view.cell_size) {
    for (long left = 0; left + view.cell_size <= view.reliable.cols(); left += view.cell_size) {
      const auto cell = measure_cell(view, regions, top, left, carrier.along);
      if (cell) view.cells.push_back(*cell);
    }
  }
  return view;
}

}  // namespace palpate::sensing
