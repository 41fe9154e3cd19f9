// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/row_average.h"

#include <algorithm>
#include <vector>

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {
/// Binomial mean of five pixels with this spacing in columns.
PALPATE_HOT_LOOP void average_five(const float* in, long step, float* __restrict out,
                                   long columns) {
  for (long i = 2 * step; i + 2 * step < columns; ++i) {
    out[i] =
        (in[i - 2 * step] + in[i + 2 * step] + 4 * (in[i - step] + in[i + step]) + 6 * in[i]) / 16;
  }
}
}  // namespace

void average_row(const float* in, int averages, float* out, long columns) {
  const long edge = std::min<long>(2, columns);
  std::copy_n(in, edge, out);
  std::copy_n(in + columns - edge, edge, out + columns - edge);
  average_five(in, 1, out, columns);
  std::vector<float> before;
  for (int i = 1; i < averages; ++i) {
    before.assign(out, out + columns);
    average_five(before.data(), 1L << i, out, columns);
  }
}

}  // namespace palpate::sensing
