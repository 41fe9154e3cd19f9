// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "decode/decoder_geometry.h"
#include "image/image_plane.h"
#include "palpate/sensing/reason.h"
#include "phase/chromatic.h"
#include "phase/demodulation.h"
#include "regions/phase_offset.h"

namespace palpate::sensing {

/// The images of one decode, of the working image's size, in the order in which they come to be.
/// They keep their memory from frame to frame: every stage writes into the ones it is given.
struct Workspace {
  std::vector<Plane> whole;  ///< channels of the frame, if it is decoded at half its size
  std::vector<Plane> channels;
  Mask lit;
  Demodulation demodulated;
  Combined combined;
  Mask modulated;  ///< lit, and the sinusoid is strong enough
  Mask clipped;    ///< a channel is at full scale
  ReasonImage reasons;
  Plane wrapped;
  Plane variance;
  UnwrappingBuffers unwrapping;
  Regions regions;
  Plane hue;
  std::vector<Transition> transitions;
  std::vector<PhaseGuess> guesses;
  std::vector<Marker> markers;
  OffsetBuffers voting;
  std::vector<RegionOffset> offsets;
  Plane phase;  ///< absolute; NaN where unknown
  Mask inner;   ///< lit, and so is all around
  Mask breaks;  ///< near a step of the phase
  SurfaceImages surfaces;
  Mask contradicting;  ///< the colours around say so
  Plane sigma;         ///< [mm] of the depths
};

}  // namespace palpate::sensing
