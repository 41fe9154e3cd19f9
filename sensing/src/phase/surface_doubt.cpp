// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/surface_doubt.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>

#include "image/hot_loop.h"
#include "phase/doubtful_change.h"
#include "phase/light_step.h"

namespace palpate::sensing {
namespace {

/// Contrast (a - b) / (a + b) of the modulations a period before and behind a pixel, and change of
/// the frequency there as part of the carrier's, that are rare on any surface. A sphere before a
/// smooth wall would lose its depths if they were smaller.
constexpr float kDoubtfulModulation = 0.4F;
constexpr float kDoubtfulFrequency = 0.3F;
/// Contrast of the light across the columns.
constexpr DoubtfulChange kLight{.most = 0.25, .least = 0.04, .typicals = 40};
/// Jumps of the phase [turns]. The largest values are compromises: with 0.15 across the columns,
/// more steps stay unseen. Down the columns, the window of the phase rounds relief.
constexpr DoubtfulChange kJumpAcross{.most = 0.1, .least = 0.012, .typicals = 20};
constexpr DoubtfulChange kJumpDown{.most = 0.25, .least = 0.012, .typicals = 14};

/// If the sinusoid hardly shows steps: part of the values above that is doubtful then, and step of
/// the light down the columns. Compromises: at half of the values a real relief falls into pieces;
/// at the whole ones, or without the light, real objects and the wall behind them are one.
constexpr float kHiddenPart = 2.0F / 3;
constexpr float kLightDown = 0.15F;

/// Distance from a pixel beyond which an edge of the light at it is not seen [px].
constexpr long kEdge = 2;
/// Phases beside a pixel are averages over this part of a period, over four pixels at least.
constexpr double kSidePart = 1.0 / 8;
constexpr long kLeastSide = 4;
/// Closer to the end of a column than this part of a period, windows are cut too much.
constexpr double kCutPart = 1.0 / 4;
/// The local frequency is that between places this part of a period before and behind, at least
/// two pixels away.
constexpr double kFrequencyPart = 1.0 / 16;
/// Part of the amplitude that the window must still pass at the local frequency.
constexpr float kLeastResponse = 0.3F;
/// Doubt where the modulations cannot be compared: at the ends of a surface, beside shadows.
constexpr float kUnproven = 0.5F;
constexpr float kTurn = 2 * std::numbers::pi_v<float>;

float whole_turns_removed(float phase) { return phase - kTurn * std::nearbyint(phase / kTurn); }

/// Part of the amplitude that the window passes at a frequency beside the carrier.
class Response {
 public:
  explicit Response(const DemodulationFilter& filter) {
    for (std::size_t step = 0; step <= kSteps; ++step) {
      const double frequency = std::abs(filter.carrier) * static_cast<double>(step) / kSteps;
      double sum = 0;
      for (int k = -filter.radius; k <= filter.radius; ++k) {
        sum += static_cast<double>(filter.weight[static_cast<std::size_t>(std::abs(k))]) *
               std::cos(frequency * k);
      }
      values_.at(step) = std::max(kLeastResponse, static_cast<float>(sum));
    }
  }
  /// \param frequency as part of the carrier's
  [[nodiscard]] float at(float frequency) const {
    const float step = std::min(std::abs(frequency) * kSteps, float{kSteps});
    return values_[static_cast<std::size_t>(step + 0.5F)];
  }

 private:
  static constexpr int kSteps = 64;
  std::array<float, kSteps + 1> values_{};
};

/// The local frequency beside the carrier's, as part of it; zero where it is unknown.
void find_local_frequency(const Plane& phase, const DemodulationFilter& filter, Plane& frequency) {
  const long reach = std::max(2L, std::lround(filter.period() * kFrequencyPart));
  const float scale =
      1 / static_cast<float>(std::abs(filter.carrier) * static_cast<double>(2 * reach));
  frequency.setZero(phase.rows(), phase.cols());
  for (long row = reach; row + reach < phase.rows(); ++row) {
    for (long column = 0; column < phase.cols(); ++column) {
      const float step =
          whole_turns_removed(phase(row + reach, column) - phase(row - reach, column));
      if (!std::isnan(step)) frequency(row, column) = step * scale;
    }
  }
}

/// The modulation at the local frequency; NaN where the phase is unknown.
void find_modulation(const Combined& sinusoid, const Plane& light, const Plane& frequency,
                     const DemodulationFilter& filter, Plane& modulation) {
  const Response response(filter);
  modulation.resize(light.rows(), light.cols());
  for (long i = 0; i < light.size(); ++i) {
    modulation.data()[i] = std::hypot(sinusoid.re.data()[i], sinusoid.im.data()[i]) /
                           (light.data()[i] * response.at(frequency.data()[i]));
  }
}

/// Fills the dips of a row, between two colours of which one channel each is the brightest.
void fill_dips(long row, Plane& light) {
  const long columns = light.cols();
  const Eigen::ArrayXf known = light.row(row).isNaN().select(0, light.row(row));
  Eigen::ArrayXf widened(columns);
  const auto around = [&](const Eigen::ArrayXf& values, long column) {
    const long first = std::max(0L, column - 2 * kEdge);
    return values.segment(first, std::min(columns, column + 2 * kEdge + 1) - first);
  };
  for (long column = 0; column < columns; ++column)
    widened[column] = around(known, column).maxCoeff();
  for (long column = 0; column < columns; ++column) {
    if (!std::isnan(light(row, column))) light(row, column) = around(widened, column).minCoeff();
  }
}

/// Removes the values within this many rows of an unknown one in their column, or of its end.
void drop_ends(long distance, Plane& values) {
  for (long column = 0; column < values.cols(); ++column) {
    long first = 0;  // of the known values that end at the row
    for (long row = 0; row <= values.rows(); ++row) {
      if (row < values.rows() && !std::isnan(values(row, column))) continue;
      const long cut = std::min(distance, row - first);
      values.col(column).segment(first, cut) = kUnknown;
      values.col(column).segment(row - cut, cut) = kUnknown;
      first = row + 1;
    }
  }
}

/// Writes the contrast of two values. If they are not both known, it is that of two others.
PALPATE_HOT_LOOP void find_contrast(const float* one, const float* other, const float* near_one,
                                    const float* near_other, float* __restrict contrast,
                                    long count) {
  for (long i = 0; i < count; ++i) {
    const float far = (one[i] - other[i]) / (one[i] + other[i]);
    const float near = (near_one[i] - near_other[i]) / (near_one[i] + near_other[i]);
    contrast[i] = far == far ? far : near;
  }
}

/// Rows of the phase half a period, and one and a half, before and behind a row.
struct PhaseRows {
  const float* far_before;
  const float* before;
  const float* behind;
  const float* far_behind;
};

/// Writes the change of the phase's slope over a period from before the row to behind it, and the
/// jump of the phase between the two sides, each continued to the row [turns]. The slopes are
/// known up to a turn; half of their difference, in place of their mean, keeps the jump right.
PALPATE_HOT_LOOP void find_phase_changes(const PhaseRows& rows, float* __restrict bend,
                                         float* __restrict jump, long count) {
  const PhaseRows r = rows;
  for (long i = 0; i < count; ++i) {
    const float slope_before = r.before[i] - r.far_before[i];
    const float turns = ((r.far_behind[i] - r.behind[i]) - slope_before) * (1 / kTurn);
    const float change = turns - std::nearbyint(turns);
    const float continued = (r.behind[i] - r.before[i] - slope_before) * (1 / kTurn) - change / 2;
    bend[i] = change;
    jump[i] = continued - std::nearbyint(continued);
  }
}

void add_changes_down(const Plane& modulation, const Plane& phase, double period, float part,
                      Plane& doubt) {
  const long whole = std::lround(period);
  const long half = whole / 2;
  const long rows = doubt.rows();
  const long columns = doubt.cols();
  const Eigen::ArrayXf unknown = Eigen::ArrayXf::Constant(columns, kUnknown);
  const auto row_of = [&](const Plane& plane, long row) {
    return row >= 0 && row < rows ? &plane(row, 0) : unknown.data();
  };
  Plane contrast(rows, columns), bend(rows, columns), jump(rows, columns);
  for (long row = 0; row < rows; ++row) {
    find_contrast(row_of(modulation, row - whole), row_of(modulation, row + whole),
                  row_of(modulation, row - half), row_of(modulation, row + half), &contrast(row, 0),
                  columns);
    find_phase_changes({row_of(phase, row - 3 * half), row_of(phase, row - half),
                        row_of(phase, row + half), row_of(phase, row + 3 * half)},
                       &bend(row, 0), &jump(row, 0), columns);
  }
  add_doubt(contrast, part * kDoubtfulModulation, kUnproven, doubt);
  add_doubt(bend, part * kDoubtfulFrequency, 0, doubt);
  add_doubt(jump, part * doubtful_change(jump, kJumpDown), 0, doubt);
}

/// Sums of the sinusoid over ranges of a row, where the phase is known.
class SideSums {
 public:
  void start(const Combined& sinusoid, const Plane& light, long row) {
    const long columns = light.cols();
    sum_.assign(static_cast<std::size_t>(columns + 1), {});
    count_.assign(sum_.size(), 0);
    for (long column = 0; column < columns; ++column) {
      const auto at = static_cast<std::size_t>(column);
      const bool known = !std::isnan(light(row, column));
      sum_[at + 1] = sum_[at];
      count_[at + 1] = count_[at] + (known ? 1 : 0);
      if (!known) continue;
      sum_[at + 1] += std::complex<double>(static_cast<double>(sinusoid.re(row, column)),
                                           static_cast<double>(sinusoid.im(row, column)));
    }
  }
  /// None if the phase is known on less than half of the range.
  [[nodiscard]] std::optional<std::complex<double>> over(long first, long width) const {
    const long columns = static_cast<long>(count_.size()) - 1;
    const auto begin = static_cast<std::size_t>(std::clamp(first, 0L, columns));
    const auto end = static_cast<std::size_t>(std::clamp(first + width, 0L, columns));
    if (2 * (count_[end] - count_[begin]) < width) return std::nullopt;
    return sum_[end] - sum_[begin];
  }

 private:
  std::vector<std::complex<double>> sum_;
  std::vector<long> count_;
};

/// Change of the phase from one range to the next; zero if it is not known.
double slope(const std::optional<std::complex<double>>& from,
             const std::optional<std::complex<double>>& to) {
  return from && to ? std::arg(*to * std::conj(*from)) : 0;
}

/// Adds the doubt of the jump of the phase between the two sides of a pixel, each continued to it.
void add_jumps(const Combined& sinusoid, const Plane& light, double period, float part,
               Plane& doubt) {
  const long side = std::max(kLeastSide, std::lround(period * kSidePart));
  const double to_pixel = static_cast<double>(kEdge) + static_cast<double>(side - 1) / 2;
  const double ranges = to_pixel / static_cast<double>(side);
  SideSums sums;
  Plane jumps = Plane::Constant(light.rows(), light.cols(), kUnknown);
  Plane at_ends = jumps;  // of rows, which cut the ranges short
  for (long row = 0; row < light.rows(); ++row) {
    sums.start(sinusoid, light, row);
    for (long column = 0; column < light.cols(); ++column) {
      if (std::isnan(light(row, column))) continue;
      const auto left = sums.over(column - kEdge - side + 1, side);
      const auto right = sums.over(column + kEdge, side);
      if (!left || !right) continue;
      const double by_slopes = slope(sums.over(column - kEdge - 2 * side + 1, side), left) +
                               slope(right, sums.over(column + kEdge + side, side));
      const auto jump = static_cast<float>(slope(left, right) - ranges * by_slopes);
      const bool whole =
          column - kEdge - 2 * side + 1 >= 0 && column + kEdge + 2 * side <= light.cols();
      (whole ? jumps : at_ends)(row, column) = whole_turns_removed(jump) / kTurn;
    }
  }
  add_doubt(jumps, part * doubtful_change(jumps, kJumpAcross), 0, doubt);
  add_doubt(at_ends, part * static_cast<float>(kJumpAcross.most), 0, doubt);
}

}  // namespace

void find_surface_doubt(const SurfaceSignal& signal, const DemodulationFilter& filter,
                        const DoubtOptions& options, SurfaceDoubt& doubt) {
  const float part = options.steps_show ? 1 : kHiddenPart;
  const long rows = signal.wrapped.rows();
  const long columns = signal.wrapped.cols();
  const auto known = signal.variance.isFinite();
  // The light of the brightest channel.
  Plane light = Plane::Zero(rows, columns);
  for (const Demodulated& channel : signal.channels) light = light.max(channel.mean);
  light = known.select(light, kUnknown);
  doubt.across = signal.variance / static_cast<float>(options.max_variance);
  doubt.down = doubt.across;

  Plane phase = known.select(signal.wrapped, kUnknown);
  Plane frequency, modulation;
  find_local_frequency(phase, filter, frequency);
  doubt.down += frequency.square();  // at 1 beside the carrier, the window passes nothing
  find_modulation(signal.combined, light, frequency, filter, modulation);
  const long cut = std::lround(filter.period() * kCutPart);
  drop_ends(cut, modulation);
  drop_ends(cut, phase);
  add_changes_down(modulation, phase, filter.period(), part, doubt.down);
  Plane contrast;
  if (!options.steps_show) {
    Plane inner = light;
    drop_ends(cut, inner);
    find_light_steps(inner, std::lround(filter.period() / 2), contrast);
    add_doubt(contrast, kLightDown, 0, doubt.down);
  }

  contrast.setConstant(rows, columns, kUnknown);
  for (long row = 0; row < rows && columns > 2 * kEdge; ++row) {
    if (signal.channels.size() > 1) fill_dips(row, light);
    const float* const one = &light(row, 0);
    const float* const other = &light(row, 2 * kEdge);
    find_contrast(one, other, one, other, &contrast(row, kEdge), columns - 2 * kEdge);
  }
  add_doubt(contrast, part * doubtful_change(contrast, kLight), 0, doubt.across);
  add_jumps(signal.sharp, light, filter.period(), part, doubt.across);
}

}  // namespace palpate::sensing
