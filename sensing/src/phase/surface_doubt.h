// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "image/image_plane.h"
#include "phase/chromatic.h"
#include "phase/demodulation.h"

namespace palpate::sensing {

/// Images of the surfaces under a single sinusoid.
struct SurfaceSignal {
  const std::vector<Demodulated>& channels;
  const Combined& combined;
  const Combined& sharp;  ///< averaged along the rows as little as possible
  const Plane& wrapped;   ///< [rad]
  const Plane& variance;  ///< [rad^2] of the phase around each pixel; infinite where it is unknown
};

/// Doubt that a pixel is on one surface: from 1 on two surfaces may meet there. Infinite where the
/// phase is unknown.
struct SurfaceDoubt {
  Plane down;    ///< between the pixels before and behind it in its column
  Plane across;  ///< between those beside it in its row
};

struct DoubtOptions {
  double max_variance = 0;  ///< of the phase on one surface [rad^2]
  bool steps_show = true;  ///< false if the sinusoid hardly shows steps: smaller changes are doubts
};

/// A step of depth changes the phase by whole turns and a fraction. The fraction does not show the
/// whole turns, and if it is small the phase does not show the step. But the other surface has
/// another distance, slope and material. The doubt is a sum of squares, each divided by a value
/// that is rare on the surfaces of the image (`DoubtfulChange`):
///   the unevenness of the phase;
///   down the columns, along which a window of two periods joins both surfaces, the change of the
///   modulation (amplitude over light, as it is at the local frequency) and of the frequency
///   between places a period before and behind, the jump of the phase as it is continued from
///   either side, and a frequency far from the carrier;
///   across them, where little is blurred, the jump of the phase as it is continued from either
///   side, and that of the light.
/// If one of the places has no phase, nothing is added, but half a doubt for the modulation.
/// If the sinusoid hardly shows steps, its changes and those of the light across the columns are
/// doubts at two thirds of these values, and the step of the light down the columns is added.
void find_surface_doubt(const SurfaceSignal& signal, const DemodulationFilter& filter,
                        const DoubtOptions& options, SurfaceDoubt& doubt);

}  // namespace palpate::sensing
