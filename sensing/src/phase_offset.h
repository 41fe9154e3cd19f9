// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "palpate/sensing/reason.h"
#include "unwrapping.h"

namespace palpate::sensing {

/// What a stripe transition says of the phase at a pixel.
struct PhaseGuess {
  int row = 0;
  int column = 0;
  double phase = 0;  ///< [rad] absolute
  double score = 0;  ///< weight, > 0
  int edge = 0;      ///< of the pattern, from which it comes
};

/// The guesses that can be trusted one by one: they come near a whole number of turns, and so do
/// guesses from the same stripe edge on the neighbouring scanlines, to the same number.
/// \param guesses in the order of rows.
[[nodiscard]] std::vector<Marker> find_markers(const Regions& regions,
                                               const std::vector<PhaseGuess>& guesses);

/// What is to be added to the unwrapped phase of a region.
struct RegionOffset {
  std::optional<double> phase;            ///< [rad] a multiple of 2 pi
  Reason reason = Reason::no_transition;  ///< `reconstructed`, or why there is none
};

/// The multiple of 2 pi to be added to the unwrapped phase of each region (Eq. 3.12): the rounded
/// weighted median of what its guesses say. Nothing for a region with too few guesses
/// (no_transition), or of whose guesses less than `min_agreement` (by weight) come to the same
/// multiple (ambiguous_offset).
[[nodiscard]] std::vector<RegionOffset> region_offsets(const Regions& regions,
                                                       const std::vector<PhaseGuess>& guesses,
                                                       double min_agreement);

/// The same from one known phase, for a pattern without stripes: gives the region of the pixel
/// nearest to the guess, at most `reach` px away in row and column, its offset. All other regions
/// stay without.
[[nodiscard]] std::vector<RegionOffset> anchored_offsets(const Regions& regions,
                                                         const PhaseGuess& anchor, long reach);

}  // namespace palpate::sensing
