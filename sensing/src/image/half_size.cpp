// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "image/half_size.h"

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

/// Weights of the four rows around the middle of two, and of the two neighbours in each row.
PALPATE_HOT_LOOP void average(const float* above, const float* upper, const float* lower,
                              const float* below, float outer, float inner, long columns,
                              float* __restrict out) {
  for (long i = 0; i < columns; ++i) {
    const long k = 2 * i;
    out[i] = outer * (above[k] + above[k + 1] + below[k] + below[k + 1]) +
             inner * (upper[k] + upper[k + 1] + lower[k] + lower[k + 1]);
  }
}

}  // namespace

geometry::Camera half_size(const geometry::Camera& camera) {
  geometry::Camera half = camera;
  half.width = camera.width / 2;
  half.height = camera.height / 2;
  half.fx = camera.fx / 2;
  half.fy = camera.fy / 2;
  half.cx = half_size(camera.cx);
  half.cy = half_size(camera.cy);
  return half;
}

void half_size(const std::vector<Plane>& whole, std::vector<Plane>& half) {
  half.resize(whole.size());
  for (std::size_t channel = 0; channel < whole.size(); ++channel) {
    const Plane& in = whole[channel];
    Plane& out = half[channel];
    out.resize(in.rows() / 2, in.cols() / 2);
    for (long row = 0; row < out.rows(); ++row) {
      // At the image's border use only the two rows, which have the same middle.
      const bool border = row == 0 || 2 * row + 2 >= in.rows();
      const long reach = border ? 0 : 1;
      average(&in(2 * row - reach, 0), &in(2 * row, 0), &in(2 * row + 1, 0),
              &in(2 * row + 1 + reach, 0), border ? 0.0F : 1.0F / 16, border ? 0.25F : 3.0F / 16,
              out.cols(), &out(row, 0));
    }
  }
}

}  // namespace palpate::sensing
