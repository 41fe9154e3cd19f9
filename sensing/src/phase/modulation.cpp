// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/modulation.h"

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

/// The limits for the squared half amplitude.
struct Limits {
  float least = 0;  ///< half the least amplitude
  float ratio = 0;  ///< half the least ratio
};

PALPATE_HOT_LOOP void compare(const float* re, const float* im, const float* mean,
                              const std::uint8_t* lit, Limits limits, long count,
                              std::uint8_t* __restrict modulated) {
  for (long i = 0; i < count; ++i) {
    const float wanted = limits.ratio * mean[i];
    const float least = wanted > limits.least ? wanted : limits.least;
    const bool enough = re[i] * re[i] + im[i] * im[i] >= least * least;
    modulated[i] = enough ? lit[i] : 0;
  }
}

PALPATE_HOT_LOOP void projector_mean(const float* a, const float* b, const float* c, float shared,
                                     long count, float* __restrict mean) {
  for (long i = 0; i < count; ++i) {
    const float low = a[i] < b[i] ? a[i] : b[i];
    const float lowest = low < c[i] ? low : c[i];
    mean[i] = a[i] + b[i] + c[i] - shared * lowest;
  }
}

}  // namespace

void find_modulated(const Combined& combined, const std::vector<Demodulated>& channels,
                    const Mask& lit, const ModulationLimits& limits, Mask& modulated) {
  modulated.resize(lit.rows(), lit.cols());
  const Limits half{static_cast<float>(limits.min_amplitude / 2),
                    static_cast<float>(limits.min_ratio / 2)};
  const float shared = limits.colored ? 3.0F : 0.0F;
  Eigen::ArrayXf sum(lit.cols());
  for (long row = 0; row < lit.rows(); ++row) {
    const float* mean = &channels[0].mean(row, 0);
    if (channels.size() == 3) {
      projector_mean(mean, &channels[1].mean(row, 0), &channels[2].mean(row, 0), shared, lit.cols(),
                     sum.data());
      mean = sum.data();
    }
    compare(&combined.re(row, 0), &combined.im(row, 0), mean, &lit(row, 0), half, lit.cols(),
            &modulated(row, 0));
  }
}

}  // namespace palpate::sensing
