// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/surface_doubt.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

/// Standard deviation of the phase [rad]. Steps of depth have more; relief under a coarse sinusoid,
/// whose shading does not fit it, has up to about 0.1.
constexpr float kDoubtfulSigma = 0.15F;
/// Contrast (a - b) / (a + b) of the modulations of two surfaces: a factor of two.
constexpr float kDoubtfulModulation = 0.33F;
/// Change of the frequency, as part of the carrier's.
constexpr float kDoubtfulFrequency = 0.5F;
/// Distance to both sides of an edge of the light [px].
constexpr long kEdge = 2;

PALPATE_HOT_LOOP void keep_brighter(const float* mean, float* __restrict light, long count) {
  for (long i = 0; i < count; ++i) light[i] = mean[i] > light[i] ? mean[i] : light[i];
}

PALPATE_HOT_LOOP void find_modulation(const float* re, const float* im, const float* light,
                                      float* __restrict modulation, long count) {
  for (long i = 0; i < count; ++i)
    modulation[i] = std::sqrt(re[i] * re[i] + im[i] * im[i]) / light[i];
}

PALPATE_HOT_LOOP void start_doubt(const float* variance, const float* sigma, float max_variance,
                                  float* __restrict doubt, long count) {
  constexpr float kScale = 1 / (kDoubtfulSigma * kDoubtfulSigma);
  for (long i = 0; i < count; ++i)
    doubt[i] = variance[i] / max_variance + sigma[i] * sigma[i] * kScale;
}

/// Adds the square of the contrast of two values, where both are known.
PALPATE_HOT_LOOP void add_contrast(const float* one, const float* other, float doubtful,
                                   float* __restrict doubt, long count) {
  for (long i = 0; i < count; ++i) {
    const float contrast = (one[i] - other[i]) / ((one[i] + other[i]) * doubtful);
    const float square = contrast * contrast;
    doubt[i] += square == square ? square : 0;
  }
}

/// Rows of an image half a period, and one and a half, before and behind a row.
struct PhaseRows {
  const float* far_before;
  const float* before;
  const float* behind;
  const float* far_behind;
};

/// Adds the square of the change of the phase over a period from before the row to behind it.
PALPATE_HOT_LOOP void add_frequency(const PhaseRows& rows, const PhaseRows& variances,
                                    float* __restrict doubt, long count) {
  const PhaseRows r = rows;
  const PhaseRows v = variances;
  constexpr float kTurn = 2 * std::numbers::pi_v<float>;
  for (long i = 0; i < count; ++i) {
    const float turns =
        ((r.far_behind[i] - r.behind[i]) - (r.before[i] - r.far_before[i])) * (1 / kTurn);
    const float change = (turns - std::nearbyint(turns)) * (1 / kDoubtfulFrequency);
    const float variance = v.far_before[i] + v.before[i] + v.behind[i] + v.far_behind[i];
    const bool known = variance < std::numeric_limits<float>::infinity();
    doubt[i] += known ? change * change : 0;
  }
}

}  // namespace

void find_surface_doubt(const SurfaceSignal& signal, const DemodulationFilter& filter,
                        const DoubtLimits& limits, Plane& doubt) {
  const long rows = signal.wrapped.rows();
  const long columns = signal.wrapped.cols();
  // Of the brightest channel: stripes of saturated colours, which it does not show, are no edges.
  Plane light = Plane::Zero(rows, columns);
  for (const Demodulated& channel : signal.channels)
    keep_brighter(channel.mean.data(), light.data(), light.size());
  // NaN where the phase is not known: what is compared with it then says nothing.
  Plane modulation(rows, columns);
  find_modulation(signal.combined.re.data(), signal.combined.im.data(), light.data(),
                  modulation.data(), modulation.size());
  modulation = signal.variance.isFinite().select(modulation, kUnknown);
  doubt.resize(rows, columns);
  start_doubt(signal.variance.data(), signal.sigma.data(), static_cast<float>(limits.variance),
              doubt.data(), doubt.size());
  const long period = std::lround(filter.period());
  const long half = period / 2;
  for (long row = period; row + period < rows; ++row) {
    add_contrast(&modulation(row - period, 0), &modulation(row + period, 0), kDoubtfulModulation,
                 &doubt(row, 0), columns);
    const long far = period + half;
    if (row < far || row + far >= rows) continue;
    const auto around = [&](const Plane& image) {
      return PhaseRows{&image(row - far, 0), &image(row - half, 0), &image(row + half, 0),
                       &image(row + far, 0)};
    };
    add_frequency(around(signal.wrapped), around(signal.variance), &doubt(row, 0), columns);
  }
  light = signal.variance.isFinite().select(light, kUnknown);
  for (long row = 0; row < rows && columns > 2 * kEdge; ++row) {
    add_contrast(&light(row, 0), &light(row, 2 * kEdge), static_cast<float>(limits.light),
                 &doubt(row, kEdge), columns - 2 * kEdge);
  }
}

}  // namespace palpate::sensing
