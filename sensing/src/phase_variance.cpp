// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase_variance.h"

#include <algorithm>
#include <limits>

#include "hot_loop.h"
#include "hue.h"

namespace palpate::sensing {
namespace {

/// Count, sum and sum of squares of differences.
struct Moments {
  explicit Moments(const Plane& like)
      : count(Plane::Zero(like.rows(), like.cols())), sum(count), squares(count) {}
  Plane count;
  Plane sum;
  Plane squares;
};

void add_difference(Moments& moments, long row, long column, float difference) {
  moments.count(row, column) = 1;
  moments.sum(row, column) = difference;
  moments.squares(row, column) = difference * difference;
}

PALPATE_HOT_LOOP void sum_three(const float* a, const float* b, const float* c, float* out,
                                long count) {
  for (long i = 0; i < count; ++i) out[i] = a[i] + b[i] + c[i];
}

/// Sum over 3 x 3 pixels, those outside the image being zero.
Plane box_sum(const Plane& in) {
  const long rows = in.rows();
  const long columns = in.cols();
  const Plane zero = Plane::Zero(1, columns);
  Plane down(rows, columns);
  for (long row = 0; row < rows; ++row) {
    sum_three(row > 0 ? &in(row - 1, 0) : zero.data(), &in(row, 0),
              row + 1 < rows ? &in(row + 1, 0) : zero.data(), &down(row, 0), columns);
  }
  Plane out = down;
  for (long row = 0; row < rows; ++row) {
    sum_three(&down(row, 0), &down(row, 1), &down(row, 2), &out(row, 1), columns - 2);
    out(row, 0) = down(row, 0) + down(row, 1);
    out(row, columns - 1) = down(row, columns - 2) + down(row, columns - 1);
  }
  return out;
}

PALPATE_HOT_LOOP void add_variance(const float* count, const float* sum, const float* squares,
                                   float* variance, long pixels) {
  for (long i = 0; i < pixels; ++i) {
    const float n = count[i] > 1 ? count[i] : 1;
    const float mean = sum[i] / n;
    const float value = squares[i] / n - mean * mean;
    variance[i] += value > 0 ? value : 0;
  }
}

}  // namespace

Plane phase_variance(const Plane& wrapped, const Mask& mask) {
  const long rows = wrapped.rows();
  const long columns = wrapped.cols();
  if (rows < 3 || columns < 3)  // no 3 x 3 pixels: nothing is known of any
    return Plane::Constant(rows, columns, std::numeric_limits<float>::infinity());
  Plane variance = Plane::Zero(rows, columns);
  for (const long step : {1L, columns}) {
    Moments moments(wrapped);
    const long last_row = step == 1 ? rows : rows - 1;
    const long last_column = step == 1 ? columns - 1 : columns;
    for (long row = 0; row < last_row; ++row) {
      const float* phase = &wrapped(row, 0);
      const std::uint8_t* inside = &mask(row, 0);
      for (long column = 0; column < last_column; ++column) {
        if (inside[column] == 0 || inside[column + step] == 0) continue;
        add_difference(moments, row, column, wrap(phase[column + step] - phase[column]));
      }
    }
    const Plane count = box_sum(moments.count);
    const Plane sum = box_sum(moments.sum);
    const Plane squares = box_sum(moments.squares);
    add_variance(count.data(), sum.data(), squares.data(), variance.data(), variance.size());
  }
  return (mask != 0).select(variance, std::numeric_limits<float>::infinity());
}

}  // namespace palpate::sensing
