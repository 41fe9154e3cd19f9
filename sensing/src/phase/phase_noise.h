// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "phase/chromatic.h"
#include "phase/light_groups.h"

namespace palpate::sensing {

/// Noise of a frame, estimated from the frame itself.
struct FrameNoise {
  /// Variance of the quadrature component of the sum (perpendicular to the phasor), [fraction of
  /// full scale^2].
  LinearInLight quadrature;
  /// Median of the residual.
  LinearInLight residual;
};

/// Input of the noise estimate. All images have the same size.
struct PhaseSignal {
  const Plane& wrapped;  ///< [rad] phase of the sum
  const Combined& combined;
  const std::vector<Demodulated>& channels;
  const Plane& residual;  ///< see Demodulation
  const Mask& modulated;  ///< pixels with a sinusoid
};

/// Estimates the sensor noise from fourth differences of the phase across the sinusoid. Smooth
/// surfaces contribute almost nothing to them, while noise of any spectrum (demosaicing,
/// compression, rounding) contributes 70 times its variance. The pixels of a difference are as far
/// apart as the averaging along the rows reaches. Medians over groups of similar light (the sum of
/// the channels' means) suppress steps and folds; shot noise makes the variance linear in the
/// light.
[[nodiscard]] FrameNoise estimate_noise(const PhaseSignal& signal,
                                        const DemodulationFilter& filter);

/// Predicts the standard deviation of each phase [rad]; infinite or NaN where there is no signal.
/// The variance is
///   (quadrature(light) + coherent * max(0, residual - 2 residual(light))) / |sum|^2.
/// The first term is the frame's noise. The second is a residual beyond twice the usual one, caused
/// by texture, folds or steps; it does not average out along the rows, so `coherent`, half the sum
/// of the window's squared weights, covers only the rows of the window.
void predict_phase_sigma(const PhaseSignal& signal, const FrameNoise& noise,
                         const DemodulationFilter& filter, Plane& sigma);

/// Adds the remaining chromatic error where red or blue replaces green to the standard deviation of
/// each phase; its variance is (share of red)^2 error.red + (share of blue)^2 error.blue.
void add_chromatic_error(const ChannelShares& shares, const ChromaticError& error, Plane& sigma);

}  // namespace palpate::sensing
