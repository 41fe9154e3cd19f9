// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "image/image_plane.h"
#include "phase/chromatic.h"
#include "phase/demodulation.h"

namespace palpate::sensing {

/// What a single sinusoid shows of its surface, besides the phase.
struct SurfaceSignal {
  const std::vector<Demodulated>& channels;
  const Combined& combined;
  const Plane& wrapped;   ///< [rad]
  const Plane& variance;  ///< [rad^2] of the steps of the phase around each pixel; may be infinite
  const Plane& sigma;     ///< [rad] of each phase
};

struct DoubtLimits {
  double variance = 0;  ///< [rad^2] of the phase of a smooth surface
  double light = 0;     ///< contrast (a - b) / (a + b) of the lights of two surfaces
};

/// Finds how much a pixel looks as if two surfaces met there: from 1 on they may.
///
/// A step of depth changes the phase by whole turns and a fraction. The fraction does not tell the
/// whole turns, and where it is small the phase shows nothing of the step. But the other surface
/// has another distance, slope and material, so the doubt is the sum of the squares of
///   sigma: how badly one sinusoid fits the window, and how uneven the phase is,
///   the change of the modulation (amplitude over light) from a period before to a period behind,
///   the change of the frequency between the same places,
///   the change of the light along the rows, where no window blurs it,
/// each divided by what a smooth surface hardly has. Where it ends, changes are not known.
void find_surface_doubt(const SurfaceSignal& signal, const DemodulationFilter& filter,
                        const DoubtLimits& limits, Plane& doubt);

}  // namespace palpate::sensing
