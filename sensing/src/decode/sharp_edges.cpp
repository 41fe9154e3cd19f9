// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/sharp_edges.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "decode/plausibility.h"
#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

PALPATE_HOT_LOOP bool differ(const std::uint8_t* one, const std::uint8_t* other, long columns) {
  int any = 0;
  for (long i = 0; i < columns; ++i) any |= one[i] ^ other[i];
  return any != 0;
}

float light_at(const std::vector<Demodulated>& channels, long row, long column) {
  float sum = 0;
  for (const Demodulated& channel : channels) sum += channel.mean(row, column);
  return sum;
}

float most_light(const std::vector<Demodulated>& channels, long row, long column, long radius) {
  const long last_row = channels[0].mean.rows() - 1;
  const long last_column = channels[0].mean.cols() - 1;
  float most = 0;
  for (long r = std::max(0L, row - radius); r <= std::min(last_row, row + radius); ++r) {
    for (long c = std::max(0L, column - radius); c <= std::min(last_column, column + radius); ++c)
      most = std::max(most, light_at(channels, r, c));
  }
  return most;
}

}  // namespace

void keep_sharp_edges(const std::vector<Demodulated>& channels, const Mask& mask, int radius,
                      Mask& inner) {
  // The part of a blurred edge's light at this distance from it.
  const auto kept =
      static_cast<float>(1 - std::erfc(radius / (kEdgeBlur * std::numbers::sqrt2)) / 2);
  Mask beside;
  erode(mask, 1, beside);
  for (long row = 0; row < mask.rows(); ++row) {
    if (!differ(&beside(row, 0), &inner(row, 0), mask.cols())) continue;
    for (long column = 0; column < mask.cols(); ++column) {
      if (beside(row, column) == 0 || inner(row, column) != 0) continue;
      const float light = light_at(channels, row, column);
      if (light >= kept * most_light(channels, row, column, radius)) inner(row, column) = 1;
    }
  }
}

}  // namespace palpate::sensing
