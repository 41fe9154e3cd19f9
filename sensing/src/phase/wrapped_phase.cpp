// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/wrapped_phase.h"

#include <cmath>
#include <numbers>

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

}  // namespace

void find_wrapped_phase(const Plane& re, const Plane& im, Plane& wrapped) {
  wrapped.resize(re.rows(), re.cols());
  find_angles(re.data(), im.data(), wrapped.data(), wrapped.size());
}

}  // namespace palpate::sensing
