// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/phase_offset.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "image/hue.h"

namespace palpate::sensing {
namespace {

/// Smallest number of guesses; one guess and its neighbours on the next scanlines may be wrong.
constexpr std::size_t kLeastGuesses = 5;

/// A guess is close to a whole number of turns if it is within this distance. Stripe edges are
/// located to about a pixel, a tenth of a turn.
constexpr double kNearTurns = 0.3;

/// A single stripe edge is trusted if the mean distance of its guesses from the whole number is at
/// most this, as for an edge located to about half a pixel over many scanlines. One edge in eight
/// that is misread as a whole passes by chance.
constexpr double kProvenTurns = 0.06;

/// Guesses are those of a single stripe edge if it has this much more of their weight than all
/// others together: nine tenths of it. The rest is then misread here and there.
constexpr double kSingleEdge = 0.8;

/// Guesses on this many consecutive scanlines confirm each other if their columns differ by at most
/// kChainColumns from one to the next.
constexpr int kChainLength = 5;
constexpr int kChainColumns = 3;

/// Counts a guess for its stripe edge against the leading one, after Boyer and Moore 1991.
void vote(Tally& tally, const PhaseGuess& guess) {
  tally.lead += guess.edge == tally.leading_edge ? guess.score : -guess.score;
  if (tally.lead >= 0) return;
  tally.lead = -tally.lead;
  tally.leading_edge = guess.edge;
}

/// The offset that follows from the tallies of one region, sorted by turns.
RegionOffset offset_of(const std::vector<Tally>& tallies, double min_agreement) {
  std::size_t guesses = 0;
  double total = 0;
  for (const Tally& tally : tallies) {
    guesses += static_cast<std::size_t>(tally.guesses);
    total += tally.weight;
  }
  if (guesses < kLeastGuesses) return {{}, Reason::no_transition};
  // Rounding preserves the order, so the median of the rounded turns is the rounded median.
  std::size_t median = 0;
  for (double sum = tallies[0].weight; sum < total / 2 && median + 1 < tallies.size();) {
    sum += tallies[++median].weight;
  }
  if (tallies[median].weight < min_agreement * total) return {{}, Reason::ambiguous_offset};
  // The guesses of a misread edge are spread uniformly between two whole numbers.
  const Tally& best = tallies[median];
  const bool several_edges = best.lead < kSingleEdge * best.weight;
  const bool proven = several_edges || best.residual <= kProvenTurns * best.weight;
  if (!proven) return {{}, Reason::no_transition};
  return {kFullTurn * tallies[median].turns, Reason::reconstructed};
}

/// Number of turns that a guess implies.
double turns_of(const Regions& regions, const PhaseGuess& guess) {
  return (guess.phase - static_cast<double>(regions.phase(guess.row, guess.column))) / kFullTurn;
}

}  // namespace

void find_markers(const Regions& regions, const std::vector<PhaseGuess>& guesses,
                  OffsetBuffers& buffers, std::vector<Marker>& markers) {
  // Each guess joins the chain that it continues. Open chains of a stripe edge are those that reach
  // the row above.
  auto& chains = buffers.chains;
  chains.clear();
  for (auto& of_edge : buffers.open_chains) of_edge.clear();
  markers.clear();
  buffers.chain_of_marker.clear();
  const int columns = static_cast<int>(regions.label.cols());
  for (const PhaseGuess& guess : guesses) {
    const int label = regions.label(guess.row, guess.column);
    if (label < 0) continue;
    const double turns = turns_of(regions, guess);
    const int whole = static_cast<int>(std::lround(turns));
    if (std::abs(turns - whole) > kNearTurns) continue;
    const auto edge = static_cast<std::size_t>(guess.edge);
    if (buffers.open_chains.size() <= edge) buffers.open_chains.resize(edge + 1);
    auto& open = buffers.open_chains[edge];
    std::erase_if(open, [&](int chain) {
      return chains[static_cast<std::size_t>(chain)].row < guess.row - 1;
    });
    const auto continued = std::find_if(open.begin(), open.end(), [&](int number) {
      const Chain& chain = chains[static_cast<std::size_t>(number)];
      return chain.row == guess.row - 1 && chain.label == label && chain.turns == whole &&
             std::abs(chain.column - guess.column) <= kChainColumns;
    });
    int number = static_cast<int>(chains.size());
    if (continued != open.end()) {
      number = *continued;
    } else {
      chains.push_back({.label = label, .turns = whole});
      open.push_back(number);
    }
    Chain& chain = chains[static_cast<std::size_t>(number)];
    chain.row = guess.row;
    chain.column = guess.column;
    ++chain.length;
    markers.push_back({guess.row * columns + guess.column, whole});
    buffers.chain_of_marker.push_back(number);
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    const auto chain = static_cast<std::size_t>(buffers.chain_of_marker[i]);
    if (chains[chain].length >= kChainLength) markers[kept++] = markers[i];
  }
  markers.resize(kept);
}

void region_offsets(const Regions& regions, const std::vector<PhaseGuess>& guesses,
                    double min_agreement, OffsetBuffers& buffers,
                    std::vector<RegionOffset>& offsets) {
  constexpr int kEnd = -1;
  auto& tallies = buffers.tallies;
  tallies.clear();
  buffers.first_tally.assign(static_cast<std::size_t>(regions.count), kEnd);
  for (const PhaseGuess& guess : guesses) {
    const int label = regions.label(guess.row, guess.column);
    if (label < 0) continue;
    const double asked = turns_of(regions, guess);
    const int turns = static_cast<int>(std::lround(asked));
    int& first = buffers.first_tally[static_cast<std::size_t>(label)];
    int at = first;
    while (at != kEnd && tallies[static_cast<std::size_t>(at)].turns != turns) {
      at = tallies[static_cast<std::size_t>(at)].next;
    }
    if (at == kEnd) {
      at = static_cast<int>(tallies.size());
      tallies.push_back({.turns = turns, .next = first});
      first = at;
    }
    Tally& tally = tallies[static_cast<std::size_t>(at)];
    ++tally.guesses;
    tally.weight += guess.score;
    tally.residual += guess.score * std::abs(asked - turns);
    vote(tally, guess);
  }
  offsets.clear();
  for (const int first : buffers.first_tally) {
    buffers.of_region.clear();
    for (int at = first; at != kEnd; at = tallies[static_cast<std::size_t>(at)].next) {
      buffers.of_region.push_back(tallies[static_cast<std::size_t>(at)]);
    }
    std::sort(buffers.of_region.begin(), buffers.of_region.end(),
              [](const Tally& a, const Tally& b) { return a.turns < b.turns; });
    offsets.push_back(offset_of(buffers.of_region, min_agreement));
  }
}

std::optional<PhaseGuess> nearest_in_region(const Regions& regions, PhaseGuess guess, long reach) {
  const long bottom = std::min(regions.label.rows() - 1, guess.row + reach);
  const long right = std::min(regions.label.cols() - 1, guess.column + reach);
  std::optional<PhaseGuess> nearest;
  long nearest_square = 0;
  for (long row = std::max<long>(0, guess.row - reach); row <= bottom; ++row) {
    for (long column = std::max<long>(0, guess.column - reach); column <= right; ++column) {
      if (regions.label(row, column) < 0) continue;
      const long down = row - guess.row;
      const long across = column - guess.column;
      const long square = down * down + across * across;
      if (nearest && square >= nearest_square) continue;
      nearest_square = square;
      nearest = guess;
      nearest->row = static_cast<int>(row);
      nearest->column = static_cast<int>(column);
    }
  }
  return nearest;
}

std::optional<Contradiction> contradicting_anchors(const Regions& regions,
                                                   const std::vector<PhaseGuess>& anchors) {
  const auto turns = [&](const PhaseGuess& anchor) {
    return std::lround(turns_of(regions, anchor));
  };
  for (std::size_t i = 0; i < anchors.size(); ++i) {
    const int region = regions.label(anchors[i].row, anchors[i].column);
    if (region < 0) continue;
    for (std::size_t k = 0; k < i; ++k) {
      if (regions.label(anchors[k].row, anchors[k].column) != region) continue;
      const long periods = std::abs(turns(anchors[i]) - turns(anchors[k]));
      if (periods != 0) return Contradiction{anchors[k], anchors[i], periods};
    }
  }
  return std::nullopt;
}

void anchored_offsets(const Regions& regions, const std::vector<PhaseGuess>& anchors,
                      std::vector<RegionOffset>& offsets) {
  offsets.assign(static_cast<std::size_t>(regions.count), {});
  for (const PhaseGuess& anchor : anchors) {
    const int label = regions.label(anchor.row, anchor.column);
    if (label < 0) continue;
    RegionOffset& offset = offsets[static_cast<std::size_t>(label)];
    const double phase = kFullTurn * std::round(turns_of(regions, anchor));
    if (offset.reason == Reason::no_transition) {
      offset = {phase, Reason::reconstructed};
    } else if (offset.phase != phase) {
      offset = {{}, Reason::ambiguous_offset};
    }
  }
}

}  // namespace palpate::sensing
