// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "palpate/sensing/reason.h"
#include "regions/unwrapping.h"

namespace palpate::sensing {

/// An estimate of the absolute phase at a pixel, from a stripe transition.
struct PhaseGuess {
  int row = 0;
  int column = 0;
  double phase = 0;  ///< [rad] absolute
  double score = 0;  ///< weight, > 0
  int edge = 0;      ///< stripe edge of the pattern that it comes from
};

/// Consistent guesses from one stripe edge on consecutive scanlines.
struct Chain {
  int label = 0;
  int turns = 0;
  int row = 0;     ///< of the last guess
  int column = 0;  ///< of the last guess
  int length = 0;
};

/// The guesses in one region for the same number of turns.
struct Tally {
  int turns = 0;
  int next = 0;  ///< index of another tally of the same region
  int guesses = 0;
  double weight = 0;
  double residual = 0;    ///< weighted sum of the guesses' distances from `turns`
  int leading_edge = -1;  ///< the stripe edge of most guesses, if one has more than half
  double lead = 0;        ///< at most its weight, at least by how much it exceeds the others'
};

/// Buffers reused by the functions below from frame to frame; they carry no state between calls.
struct OffsetBuffers {
  std::vector<Chain> chains;
  std::vector<std::vector<int>> open_chains;
  std::vector<int> chain_of_marker;
  std::vector<Tally> tallies;
  std::vector<int> first_tally;
  std::vector<Tally> of_region;
};

/// Finds the guesses that are reliable individually: they are close to a whole number of turns, and
/// guesses from the same stripe edge on the neighbouring scanlines give the same number.
/// \param guesses in the order of rows.
/// \param markers output, in the order of the guesses.
void find_markers(const Regions& regions, const std::vector<PhaseGuess>& guesses,
                  OffsetBuffers& buffers, std::vector<Marker>& markers);

/// Offset to be added to the unwrapped phase of a region.
struct RegionOffset {
  std::optional<double> phase;            ///< [rad] a multiple of 2 pi
  Reason reason = Reason::no_transition;  ///< `reconstructed`, or why there is no offset
};

/// Finds the multiple of 2 pi to be added to the unwrapped phase of each region (Eq. 3.12): the
/// rounded weighted median of its guesses.
///
/// A region gets no offset (no_transition) if it has too few guesses, or if nearly all come from a
/// single stripe edge, which may be misread as a whole, unless they are very close to the multiple.
/// It gets none (ambiguous_offset) if less than `min_agreement` of its guesses, by weight, give the
/// same multiple.
/// \param offsets output, one per region.
void region_offsets(const Regions& regions, const std::vector<PhaseGuess>& guesses,
                    double min_agreement, OffsetBuffers& buffers,
                    std::vector<RegionOffset>& offsets);

/// A guess at the pixel of a region that is nearest to its own, at most `reach` px away in row and
/// column; none if there is no such pixel.
[[nodiscard]] std::optional<PhaseGuess> nearest_in_region(const Regions& regions, PhaseGuess guess,
                                                          long reach);

/// Two anchors on one surface that are whole periods of the sinusoid apart.
struct Contradiction {
  PhaseGuess first;
  PhaseGuess second;
  long periods = 0;
};

/// The first two anchors that contradict each other; none if all agree.
[[nodiscard]] std::optional<Contradiction> contradicting_anchors(
    const Regions& regions, const std::vector<PhaseGuess>& anchors);

/// The offsets of regions from known phases, for a pattern without stripes. A region without an
/// anchor gets none (no_transition), nor does one whose anchors disagree (ambiguous_offset).
/// \param anchors in regions.
/// \param offsets output, one per region.
void anchored_offsets(const Regions& regions, const std::vector<PhaseGuess>& anchors,
                      std::vector<RegionOffset>& offsets);

}  // namespace palpate::sensing
