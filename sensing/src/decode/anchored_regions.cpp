// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/anchored_regions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "image/half_size.h"
#include "image/hue.h"
#include "image/reasons.h"
#include "palpate/error.h"
#include "phase/surface_doubt.h"
#include "regions/snakes.h"

namespace palpate::sensing {
namespace {

/// Half the width of the narrowest way on which a surface is sure to go on, in periods of the
/// sinusoid: where an edge crosses the phase, a smaller part of it hides its step.
constexpr double kNeckPeriods = 0.1;
constexpr long kLeastNeck = 3;  ///< px

/// The light falls with the square of the distance from the projector, so the contrast
/// (a - b) / (a + b) at a step of one period is its share of the distance. Edges count from this
/// part of it on, because slopes differ too; edges of shading on smooth relief stay below the
/// largest, and noise below the least.
constexpr double kLightPart = 0.8;
constexpr double kLeastLight = 0.03;
constexpr double kLargestLight = 0.125;

std::string text_of(const Anchor& anchor) {
  return fmt::format("{:g},{:g},{:g}", anchor.u_px, anchor.v_px, anchor.z);
}

/// Change of the depth for a turn of the phase, as part of the depth.
double depth_per_turn(const DecoderGeometry& model, const PhaseGuess& guess, double z) {
  constexpr double kLittle = 1e-3;
  const auto farther = model.phase_at_depth(guess.row, guess.column, z * (1 + kLittle));
  if (!farther || *farther == guess.phase) return kLargestLight;
  return kLittle * kFullTurn / std::abs(*farther - guess.phase);
}

/// The phases at the anchors; `edge` is the number of the anchor.
void find_guesses(const DecoderGeometry& whole, const DecodeOptions& options, Workspace& work) {
  const DecoderGeometry& model = work.model(whole);
  const auto decoded = [&](double pixel) {
    return static_cast<int>(std::lround(options.half_resolution ? half_size(pixel) : pixel));
  };
  work.guesses.clear();
  for (std::size_t i = 0; i < options.anchors.size(); ++i) {
    const Anchor& anchor = options.anchors[i];
    PhaseGuess guess{.row = decoded(anchor.v_px),
                     .column = decoded(anchor.u_px),
                     .score = 1,
                     .edge = static_cast<int>(i)};
    if (model.carrier().transposed) std::swap(guess.row, guess.column);
    guess.row -= static_cast<int>(work.part.row);
    guess.column -= static_cast<int>(work.part.column);
    const bool inside = guess.row >= 0 && guess.row < work.part.rows && guess.column >= 0 &&
                        guess.column < work.part.columns;
    if (!inside) continue;
    const auto phase = model.phase_at_depth(guess.row, guess.column, anchor.z);
    if (!phase) continue;
    guess.phase = *phase;
    work.guesses.push_back(guess);
  }
}

DoubtLimits doubt_limits(const DecoderGeometry& model, const DecodeOptions& options,
                         const std::vector<PhaseGuess>& guesses) {
  double light = kLargestLight;
  for (const PhaseGuess& guess : guesses) {
    const double z = options.anchors[static_cast<std::size_t>(guess.edge)].z;
    light = std::min(light, kLightPart * depth_per_turn(model, guess, z));
  }
  return {.variance = options.max_phase_variance, .light = std::max(light, kLeastLight)};
}

/// Moves the guesses to the nearest pixels of regions, and leaves out those that are too far away.
void move_to_regions(const Regions& regions, long reach, std::vector<PhaseGuess>& guesses) {
  std::size_t kept = 0;
  for (const PhaseGuess& guess : guesses) {
    if (const auto near = nearest_in_region(regions, guess, reach)) guesses[kept++] = *near;
  }
  guesses.resize(kept);
}

void refuse_contradiction(const DecodeOptions& options, const Workspace& work) {
  const auto pair = contradicting_anchors(work.regions, work.guesses);
  if (!pair) return;
  const auto anchor = [&](const PhaseGuess& guess) {
    return text_of(options.anchors[static_cast<std::size_t>(guess.edge)]);
  };
  throw InvalidInput(fmt::format(
      "the anchors {} and {} contradict each other: both are on one smooth surface, whose phases "
      "say that one of the two depths is wrong by {} whole periods of the sinusoid. Measure both "
      "again, or leave one out",
      anchor(pair->first), anchor(pair->second), pair->periods));
}

/// Gives pixels without an anchor that a smooth phase connects with one their reason.
void tell_possible_steps(const Labels& smooth, int smooth_count, Workspace& work) {
  std::vector<std::uint8_t> anchored(static_cast<std::size_t>(smooth_count), 0);
  const auto known = [&](long pixel) {
    const int label = work.regions.label.data()[pixel];
    return label >= 0 && work.offsets[static_cast<std::size_t>(label)].phase.has_value();
  };
  for (long i = 0; i < smooth.size(); ++i) {
    const int label = smooth.data()[i];
    if (label >= 0 && known(i)) anchored[static_cast<std::size_t>(label)] = 1;
  }
  for (long i = 0; i < smooth.size(); ++i) {
    const int label = smooth.data()[i];
    if (label < 0 || known(i) || anchored[static_cast<std::size_t>(label)] == 0) continue;
    std::uint8_t& reason = work.reasons.data()[i];
    if (reason == code(Reason::reconstructed)) reason = code(Reason::possible_step);
  }
}

}  // namespace

void find_anchored_regions(const DecoderGeometry& whole, const DemodulationFilter& filter,
                           const DecodeOptions& options, Workspace& work) {
  const FloodLimits smooth{.max_variance = options.max_phase_variance,
                           .max_step = options.max_phase_step};
  grow_regions(work.wrapped, work.variance, smooth, work.unwrapping, work.regions);
  const int smooth_count = work.regions.count;
  work.smooth.swap(work.regions.label);
  find_guesses(whole, options, work);
  find_surface_doubt({.channels = work.demodulated.channels,
                      .combined = work.combined,
                      .wrapped = work.wrapped,
                      .variance = work.variance,
                      .sigma = work.sigma},
                     filter, doubt_limits(work.model(whole), options, work.guesses), work.doubt);
  const FloodLimits sure{.max_variance = 1,
                         .max_step = options.max_phase_step,
                         .neck = std::max(kLeastNeck, std::lround(kNeckPeriods * filter.period()))};
  if (options.segmentation == Segmentation::snakes) {
    grow_snakes(work.wrapped, work.doubt, sure, work.regions);
  } else {
    grow_wide_regions(work.wrapped, work.doubt, sure, work.unwrapping, work.regions);
  }
  move_to_regions(work.regions, sure.neck, work.guesses);
  refuse_contradiction(options, work);
  anchored_offsets(work.regions, work.guesses, work.offsets);
  tell_possible_steps(work.smooth, smooth_count, work);
}

}  // namespace palpate::sensing
