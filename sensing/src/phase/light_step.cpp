// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/light_step.h"

#include <cmath>

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

/// Logarithms of the light half a period, and one and a half, before and behind a row.
struct LightRows {
  const float* far_before;
  const float* before;
  const float* behind;
  const float* far_behind;
};

PALPATE_HOT_LOOP void find_steps_of_row(const LightRows& rows, float* __restrict contrast,
                                        long count) {
  const LightRows r = rows;
  for (long i = 0; i < count; ++i) {
    const float near = r.behind[i] - r.before[i];
    const float slopes = (r.far_behind[i] - r.behind[i]) + (r.before[i] - r.far_before[i]);
    const float step = slopes == slopes ? near - slopes / 2 : near;
    contrast[i] = step / 2;  // of a ratio near 1, to its third power
  }
}

}  // namespace

void find_light_steps(const Plane& light, long half, Plane& contrast) {
  const Plane logarithm = light.log();
  const Eigen::ArrayXf unknown = Eigen::ArrayXf::Constant(light.cols(), kUnknown);
  const auto row_of = [&](long row) {
    return row >= 0 && row < light.rows() ? &logarithm(row, 0) : unknown.data();
  };
  contrast.resize(light.rows(), light.cols());
  for (long row = 0; row < light.rows(); ++row) {
    find_steps_of_row(
        {row_of(row - 3 * half), row_of(row - half), row_of(row + half), row_of(row + 3 * half)},
        &contrast(row, 0), light.cols());
  }
}

}  // namespace palpate::sensing
