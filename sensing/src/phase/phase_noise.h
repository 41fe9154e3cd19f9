// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "phase/chromatic.h"

namespace palpate::sensing {

/// A value that grows with the light: constant + slope * mean, neither negative.
struct LinearInLight {
  double constant = 0;
  double slope = 0;
};

/// How noisy a frame is, read from the frame itself.
struct FrameNoise {
  /// Variance of the sum's quadrature (its part across the phasor), [fraction of full scale^2].
  LinearInLight quadrature;
  /// Median of the residual.
  LinearInLight residual;
  ChromaticError chromatic;
};

/// What the noise is estimated from. All of one size.
struct PhaseSignal {
  const Plane& wrapped;  ///< [rad] phase of the sum
  const Combined& combined;
  const std::vector<Demodulated>& channels;
  const Plane& residual;  ///< see Demodulation
  const Mask& modulated;
  const ChromaticModel& chromatic;
  const Plane& phase;  ///< [rad] absolute; NaN where unknown
  PixelOfPhase pixels;
};

/// Sensor noise, from fourth differences of the phase across the sinusoid: smooth surfaces have
/// almost none, while noise, whatever its spectrum (demosaicing, compression, rounding), comes
/// through with 70 times its variance. They are taken as far apart as the averaging along
/// the rows reaches. Medians over groups of like brightness (light: the sum of the
/// channels' means) keep steps and folds out; shot noise makes the variance linear in the light.
[[nodiscard]] FrameNoise estimate_noise(const PhaseSignal& signal,
                                        const DemodulationFilter& filter);

/// Standard deviation of each phase [rad]; infinite where there is no signal. The variance is
///   (quadrature(light) + coherent * max(0, residual - 2 residual(light))) / |sum|^2
///   + (share of red)^2 chromatic.red + (share of blue)^2 chromatic.blue:
/// the frame's noise, and what the sinusoid leaves unexplained beyond twice what is usual. That is
/// texture, folds, steps: it does not average out along the rows, so `coherent`, half the sum of
/// the window's squared weights, counts the rows of the window alone. The last two are what the
/// channels still disagree by, if red or blue stands in for green.
void predict_phase_sigma(const PhaseSignal& signal, const FrameNoise& noise,
                         const DemodulationFilter& filter, Plane& sigma);

}  // namespace palpate::sensing
