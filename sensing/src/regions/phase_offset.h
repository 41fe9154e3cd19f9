// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "palpate/sensing/reason.h"
#include "regions/unwrapping.h"

namespace palpate::sensing {

/// What a stripe transition says of the phase at a pixel.
struct PhaseGuess {
  int row = 0;
  int column = 0;
  double phase = 0;  ///< [rad] absolute
  double score = 0;  ///< weight, > 0
  int edge = 0;      ///< of the pattern, from which it comes
};

/// Guesses of one stripe edge on consecutive scanlines that agree.
struct Chain {
  int label = 0;
  int turns = 0;
  int row = 0;     ///< of its last guess
  int column = 0;  ///< of its last guess
  int length = 0;
};

/// The guesses of one region that ask for one number of turns.
struct Tally {
  int turns = 0;
  int next = 0;  ///< another of its region
  int guesses = 0;
  double weight = 0;
  double residual = 0;         ///< weighted sum of their distances from `turns`
  int edge = -1;               ///< stripe edge that the first comes from
  bool several_edges = false;  ///< they come from more than one
};

/// Memory that the functions below use again from frame to frame; it says nothing between calls.
struct OffsetBuffers {
  std::vector<Chain> chains;
  std::vector<std::vector<int>> open_chains;
  std::vector<int> chain_of_marker;
  std::vector<Tally> tallies;
  std::vector<int> first_tally;
  std::vector<Tally> of_region;
};

/// The guesses that can be trusted one by one: they come near a whole number of turns, and so do
/// guesses from the same stripe edge on the neighbouring scanlines, to the same number.
/// \param guesses in the order of rows.
/// \param markers takes the result, in the order of the guesses.
void find_markers(const Regions& regions, const std::vector<PhaseGuess>& guesses,
                  OffsetBuffers& buffers, std::vector<Marker>& markers);

/// What is to be added to the unwrapped phase of a region.
struct RegionOffset {
  std::optional<double> phase;            ///< [rad] a multiple of 2 pi
  Reason reason = Reason::no_transition;  ///< `reconstructed`, or why there is none
};

/// The multiple of 2 pi to be added to the unwrapped phase of each region (Eq. 3.12): the rounded
/// weighted median of what its guesses say. Nothing for a region with too few guesses, or
/// from a single stripe edge, which may have been misread all along, unless they come very near to
/// the multiple (no_transition), or of
/// whose guesses less than `min_agreement` (by weight) come to the same
/// multiple (ambiguous_offset).
/// \param offsets takes the result, one a region.
void region_offsets(const Regions& regions, const std::vector<PhaseGuess>& guesses,
                    double min_agreement, OffsetBuffers& buffers,
                    std::vector<RegionOffset>& offsets);

/// The same from one known phase, for a pattern without stripes: gives the region of the pixel
/// nearest to the guess, at most `reach` px away in row and column, its offset. All other regions
/// stay without.
[[nodiscard]] std::vector<RegionOffset> anchored_offsets(const Regions& regions,
                                                         const PhaseGuess& anchor, long reach);

}  // namespace palpate::sensing
