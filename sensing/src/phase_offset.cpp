// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase_offset.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace palpate::sensing {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// One guess may be wrong, and so may be its neighbours on the next scanlines.
constexpr std::size_t kLeastGuesses = 5;

/// A guess is near a whole number of turns iff it is at most this far from it. Stripe edges are
/// found to about a pixel, a tenth of a turn.
constexpr double kNearTurns = 0.3;

/// Guesses of so many scanlines in a row confirm each other iff their columns differ by at most
/// kChainColumns from one to the next.
constexpr int kChainLength = 5;
constexpr int kChainColumns = 3;

struct Vote {
  double turns = 0;  ///< (guess - unwrapped phase) / 2 pi
  double weight = 0;
};

double weighted_median(std::vector<Vote>& votes) {
  std::sort(votes.begin(), votes.end(),
            [](const Vote& a, const Vote& b) { return a.turns < b.turns; });
  double total = 0;
  for (const Vote& vote : votes) total += vote.weight;
  double sum = 0;
  for (const Vote& vote : votes) {
    sum += vote.weight;
    if (sum >= total / 2) return vote.turns;
  }
  return votes.back().turns;
}

RegionOffset offset_of(std::vector<Vote>& votes, double min_agreement) {
  if (votes.size() < kLeastGuesses) return {{}, Reason::no_transition};
  const double turns = std::round(weighted_median(votes));
  double agreeing = 0;
  double total = 0;
  for (const Vote& vote : votes) {
    total += vote.weight;
    if (std::round(vote.turns) == turns) agreeing += vote.weight;
  }
  if (agreeing < min_agreement * total) return {{}, Reason::ambiguous_offset};
  return {kTurn * turns, Reason::reconstructed};
}

/// Turns that a guess asks for.
double turns_of(const Regions& regions, const PhaseGuess& guess) {
  return (guess.phase - static_cast<double>(regions.phase(guess.row, guess.column))) / kTurn;
}

}  // namespace

std::vector<Marker> find_markers(const Regions& regions, const std::vector<PhaseGuess>& guesses) {
  // Chains of guesses, one a stripe edge and label; each guess joins the chain it continues.
  struct Chain {
    const PhaseGuess* last = nullptr;
    int turns = 0;
    std::vector<Marker> markers;
  };
  std::map<std::pair<int, int>, std::vector<Chain>> chains;
  for (const PhaseGuess& guess : guesses) {
    const int label = regions.label(guess.row, guess.column);
    if (label < 0) continue;
    const double turns = turns_of(regions, guess);
    const int whole = static_cast<int>(std::lround(turns));
    if (std::abs(turns - whole) > kNearTurns) continue;
    auto& of_edge = chains[{label, guess.edge}];
    const auto continued = std::find_if(of_edge.rbegin(), of_edge.rend(), [&](const Chain& chain) {
      return chain.turns == whole && chain.last->row == guess.row - 1 &&
             std::abs(chain.last->column - guess.column) <= kChainColumns;
    });
    Chain& chain = continued != of_edge.rend() ? *continued : of_edge.emplace_back();
    chain.last = &guess;
    chain.turns = whole;
    const int columns = static_cast<int>(regions.label.cols());
    chain.markers.push_back({guess.row * columns + guess.column, whole});
  }
  std::vector<Marker> markers;
  for (const auto& [key, of_edge] : chains) {
    for (const Chain& chain : of_edge) {
      if (chain.markers.size() < kChainLength) continue;
      markers.insert(markers.end(), chain.markers.begin(), chain.markers.end());
    }
  }
  return markers;
}

std::vector<RegionOffset> region_offsets(const Regions& regions,
                                         const std::vector<PhaseGuess>& guesses,
                                         double min_agreement) {
  std::vector<std::vector<Vote>> votes(static_cast<std::size_t>(regions.count));
  for (const PhaseGuess& guess : guesses) {
    const int label = regions.label(guess.row, guess.column);
    if (label < 0) continue;
    votes[static_cast<std::size_t>(label)].push_back({turns_of(regions, guess), guess.score});
  }
  std::vector<RegionOffset> offsets;
  offsets.reserve(votes.size());
  for (auto& list : votes) offsets.push_back(offset_of(list, min_agreement));
  return offsets;
}

std::vector<RegionOffset> anchored_offsets(const Regions& regions, const PhaseGuess& anchor,
                                           long reach) {
  std::vector<RegionOffset> offsets(static_cast<std::size_t>(regions.count));
  const long bottom = std::min(regions.label.rows() - 1, anchor.row + reach);
  const long right = std::min(regions.label.cols() - 1, anchor.column + reach);
  std::optional<PhaseGuess> nearest;
  long nearest_square = 0;
  for (long row = std::max<long>(0, anchor.row - reach); row <= bottom; ++row) {
    for (long column = std::max<long>(0, anchor.column - reach); column <= right; ++column) {
      if (regions.label(row, column) < 0) continue;
      const long down = row - anchor.row;
      const long across = column - anchor.column;
      const long square = down * down + across * across;
      if (nearest && square >= nearest_square) continue;
      nearest_square = square;
      nearest = anchor;
      nearest->row = static_cast<int>(row);
      nearest->column = static_cast<int>(column);
    }
  }
  if (!nearest) return offsets;
  const auto label = static_cast<std::size_t>(regions.label(nearest->row, nearest->column));
  offsets[label] = {kTurn * std::round(turns_of(regions, *nearest)), Reason::reconstructed};
  return offsets;
}

}  // namespace palpate::sensing
