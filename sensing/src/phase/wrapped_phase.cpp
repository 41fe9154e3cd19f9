// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/wrapped_phase.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

/// The arc tangent in [0, 1] as x times a polynomial of x^2, fitted for the least largest error:
/// 4e-8, and 1.4e-7 with the rounding of single precision.
[[gnu::always_inline]] inline float arc_tangent(float x) {
  const float s = x * x;
  float sum = -0.00405456219F;
  sum = sum * s + 0.021862939F;
  sum = sum * s - 0.0559123009F;
  sum = sum * s + 0.096421957F;
  sum = sum * s - 0.139086291F;
  sum = sum * s + 0.199465662F;
  sum = sum * s - 0.333298594F;
  sum = sum * s + 0.999999344F;
  return sum * x;
}

PALPATE_HOT_LOOP void find_angles(const float* re, const float* im, float* angle, long count) {
  constexpr float kHalfTurn = std::numbers::pi_v<float>;
  for (long i = 0; i < count; ++i) {
    const float x = std::abs(re[i]);
    const float y = std::abs(im[i]);
    const float longer = x > y ? x : y;
    const float shorter = x > y ? y : x;
    const float first = arc_tangent(shorter / (longer > 0 ? longer : 1));
    const float second = x > y ? first : kHalfTurn / 2 - first;
    const float third = re[i] < 0 ? kHalfTurn - second : second;
    angle[i] = std::copysign(longer > 0 ? third : 0, im[i]);
  }
}

/// Count, sum and sum of squares of the differences in one direction, row by row.
constexpr long kMoments = 3;

/// The moments of one difference for each pixel, from `phase` to `other`; zero unless both are
/// inside the mask.
PALPATE_HOT_LOOP void take_differences(const float* phase, const float* other,
                                       const std::uint8_t* inside, const std::uint8_t* other_inside,
                                       float* __restrict count, float* __restrict sum,
                                       float* __restrict squares, long pixels) {
  constexpr float kPi = std::numbers::pi_v<float>;
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

PALPATE_HOT_LOOP void add_three(const float* left, const float* here, const float* right,
                                float* __restrict sum, long pixels) {
  for (long i = 0; i < pixels; ++i) sum[i] = left[i] + here[i] + right[i];
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
      const float* here = first + moment * stride;
      add_three(here - 1, here, here + 1, sums_[2].data() + moment * columns_, columns_);
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

void find_wrapped_phase(const Plane& re, const Plane& im, Plane& wrapped) {
  wrapped.resize(re.rows(), re.cols());
  find_angles(re.data(), im.data(), wrapped.data(), wrapped.size());
}

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
