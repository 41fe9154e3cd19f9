// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

#include "phase/phase_noise.h"
#include "phase/wrapped_phase.h"

/// Helpers that tests of the phase share.
namespace palpate::sensing {

/// [px] of waves along the rows, and their frequency [rad/px] and phase at row 0.
inline constexpr double kPeriod = 7.3;
inline constexpr double kCarrier = 2 * std::numbers::pi / kPeriod;
inline constexpr double kPhase = 0.4;

inline Plane variance_of(const Plane& wrapped, const Mask& mask) {
  Plane variance;
  phase_variance(wrapped, mask, variance);
  return variance;
}

inline Plane variance_of(const Plane& wrapped) {
  return variance_of(wrapped, Mask::Ones(wrapped.rows(), wrapped.cols()));
}

/// The phases of an image of one channel that is lit everywhere, and their predicted deviations.
struct PredictedPhases {
  explicit PredictedPhases(const Plane& image)
      : filter(make_filter(kCarrier)), lit(Mask::Ones(image.rows(), image.cols())) {
    demodulate({image}, lit, filter, demodulation);
    combine_channels(demodulation.channels, {}, combined);
    wrapped =
        combined.re.binaryExpr(combined.im, [](float re, float im) { return std::atan2(im, re); });
    const PhaseSignal signal{.wrapped = wrapped,
                             .combined = combined,
                             .channels = demodulation.channels,
                             .residual = demodulation.residual,
                             .modulated = lit};
    noise = estimate_noise(signal, filter);
    predict_phase_sigma(signal, noise, filter, sigma);
  }
  DemodulationFilter filter;
  Mask lit;
  Demodulation demodulation;
  Combined combined;
  Plane wrapped;  ///< [rad]
  FrameNoise noise;
  Plane sigma;  ///< [rad]
};

}  // namespace palpate::sensing
