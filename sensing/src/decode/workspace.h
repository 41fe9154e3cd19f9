// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "decode/decoder_geometry.h"
#include "decode/plausibility.h"
#include "decode/tinted_surfaces.h"
#include "image/image_part.h"
#include "image/image_plane.h"
#include "palpate/sensing/reason.h"
#include "phase/chromatic.h"
#include "phase/demodulation.h"
#include "regions/phase_offset.h"

namespace palpate::sensing {

/// Images of one decode, in the order of computation: first some of the working image, then those
/// of its part that is lit, which alone is decoded. They keep their memory from frame to frame, and
/// every stage overwrites its outputs.
struct Workspace {
  std::vector<Plane> full_size;  ///< channels of the frame, if it is decoded at half its size
  std::vector<Plane> image;      ///< channels of the working image; any if the part is all of it
  Mask image_lit;
  ImagePart part;
  std::optional<DecoderGeometry> part_model;  ///< empty if the part is the whole image
  /// The model of the part.
  [[nodiscard]] const DecoderGeometry& model(const DecoderGeometry& whole) const {
    return part_model ? *part_model : whole;
  }
  std::vector<Plane> channels;
  Mask lit;
  Demodulation demodulated;
  Combined combined;
  Mask modulated;  ///< lit, and the phase is precise enough
  Mask clipped;    ///< a channel is at full scale
  ReasonImage reasons;
  ReasonImage reasons_around;  ///< of the working image, if the part is not all of it
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
  TintedSurfaces::Seen tinted;
  Plane corrected_hue;  ///< used if `tinted.any`: corrected where surfaces have a colour
  Plane phase;          ///< absolute; NaN where unknown
  Mask inner;           ///< lit, with lit surroundings
  Mask breaks;          ///< close to a discontinuity of the phase
  Mask either_surface;  ///< beside a discontinuity by whole turns, on one side or the other
  SurfaceImages surfaces;
  ColorSays says;
  Mask contradicting;  ///< contradicted by the colours around
  Plane sigma;         ///< [rad] of the phases, then [mm] of the depths
  Plane noise;         ///< [mm] the part of sigma that is not the rig's; empty without
};

}  // namespace palpate::sensing
