// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/phase_variance.h"

#include <array>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// Count, sum and sum of squares of the differences in one direction, row by row.
constexpr long kMoments = 3;

/// The moments of one difference for each pixel, from `phase` to `other`; zero unless both are
/// inside the mask.
PALPATE_HOT_LOOP void take_differences(const float* phase, const float* other,
                                       const std::uint8_t* inside, const std::uint8_t* other_inside,
                                       float* __restrict count, float* __restrict sum,
                                       float* __restrict squares, long pixels) {
  for (long i = 0; i < pixels; ++i) {
    float step = other[i] - phase[i];
    step -= step > kPi ? 2 * kPi : 0;
    step += step < -kPi ? 2 * kPi : 0;
    const bool both = (inside[i] & other_inside[i]) != 0;
    step = both ? step : 0;
    count[i] = both ? 1 : 0;
    sum[i] = step;
    squares[i] = step * step;
  }
}

PALPATE_HOT_LOOP void add_neighbours(const float* in, float* __restrict out, long pixels) {
  for (long i = 0; i < pixels; ++i) out[i] = in[i - 1] + in[i] + in[i + 1];
}

/// Adds the variance over three rows of moments.
PALPATE_HOT_LOOP void add_variance(const float* above, const float* here, const float* below,
                                   float* __restrict variance, long pixels) {
  for (long i = 0; i < pixels; ++i) {
    const float found = above[i] + here[i] + below[i];
    const float n = found > 1 ? found : 1;
    const long s = i + pixels;
    const long q = s + pixels;
    const float mean = (above[s] + here[s] + below[s]) / n;
    const float value = (above[q] + here[q] + below[q]) / n - mean * mean;
    variance[i] += value > 0 ? value : 0;
  }
}

PALPATE_HOT_LOOP void forget_outside(const std::uint8_t* inside, float* __restrict variance,
                                     long pixels) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (long i = 0; i < pixels; ++i) variance[i] = inside[i] != 0 ? variance[i] : kInfinity;
}

/// The moments of the differences in one direction, summed over three columns.
class DirectionRows {
 public:
  explicit DirectionRows(long columns)
      : columns_(columns),
        single_(static_cast<std::size_t>(kMoments * (columns + 2)), 0.0F),
        sums_{Sums(static_cast<std::size_t>(kMoments * columns), 0.0F), {}, {}} {
    sums_[1] = sums_[2] = sums_[0];
  }

  /// Advances by one row; adds below the differences between the first `pixels` of two pixel rows.
  void append(const float* phase, const float* other, const std::uint8_t* inside,
              const std::uint8_t* other_inside, long pixels) {
    rotate();
    // Zeros on both sides of the row, and after the last difference.
    const long stride = columns_ + 2;
    float* first = single_.data() + 1;
    take_differences(phase, other, inside, other_inside, first, first + stride, first + 2 * stride,
                     pixels);
    for (long moment = 0; moment < kMoments; ++moment) {
      add_neighbours(first + moment * stride, sums_[2].data() + moment * columns_, columns_);
    }
  }
  /// Advances by one row to a row without differences.
  void append_nothing() {
    rotate();
    sums_[2].assign(sums_[2].size(), 0.0F);
  }
  void add_to(float* variance) const {
    add_variance(sums_[0].data(), sums_[1].data(), sums_[2].data(), variance, columns_);
  }

 private:
  using Sums = std::vector<float>;
  void rotate() {
    std::swap(sums_[0], sums_[1]);
    std::swap(sums_[1], sums_[2]);
  }

  long columns_;
  std::vector<float> single_;
  std::array<Sums, 3> sums_;  ///< of the row above, here and below
};

}  // namespace

void phase_variance(const Plane& wrapped, const Mask& mask, Plane& variance) {
  const long rows = wrapped.rows();
  const long columns = wrapped.cols();
  if (rows < 3 || columns < 3) {
    variance.setConstant(rows, columns, std::numeric_limits<float>::infinity());
    return;
  }
  variance.resize(rows, columns);
  DirectionRows right(columns);
  DirectionRows down(columns);
  for (long below = 0; below <= rows; ++below) {
    if (below < rows) {
      const float* phase = &wrapped(below, 0);
      const std::uint8_t* inside = &mask(below, 0);
      right.append(phase, phase + 1, inside, inside + 1, columns - 1);
      if (below + 1 < rows) {
        down.append(phase, phase + columns, inside, inside + columns, columns);
      } else {
        down.append_nothing();
      }
    } else {
      right.append_nothing();
      down.append_nothing();
    }
    if (below == 0) continue;
    const long row = below - 1;
    variance.row(row).setZero();
    right.add_to(&variance(row, 0));
    down.add_to(&variance(row, 0));
    forget_outside(&mask(row, 0), &variance(row, 0), columns);
  }
}

}  // namespace palpate::sensing
