// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/modulation.h"

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

PALPATE_HOT_LOOP void compare_amplitude(const float* re, const float* im, const std::uint8_t* lit,
                                        float least_square, long count,
                                        std::uint8_t* __restrict modulated) {
  for (long i = 0; i < count; ++i) {
    const bool enough = re[i] * re[i] + im[i] * im[i] >= least_square;
    modulated[i] = enough ? lit[i] : 0;
  }
}

PALPATE_HOT_LOOP void compare_sigma(const float* sigma, float largest, long count,
                                    std::uint8_t* __restrict modulated) {
  for (long i = 0; i < count; ++i) modulated[i] = sigma[i] <= largest ? modulated[i] : 0;
}

}  // namespace

void find_modulated(const Combined& combined, const Mask& lit, double min_amplitude,
                    Mask& modulated) {
  modulated.resize(lit.rows(), lit.cols());
  // re and im are half amplitudes.
  compare_amplitude(combined.re.data(), combined.im.data(), lit.data(),
                    static_cast<float>(min_amplitude * min_amplitude / 4), lit.size(),
                    modulated.data());
}

void drop_uncertain(const Plane& sigma, double max_sigma, Mask& modulated) {
  compare_sigma(sigma.data(), static_cast<float>(max_sigma), sigma.size(), modulated.data());
}

}  // namespace palpate::sensing
