// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/anchored_regions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "image/half_size.h"
#include "image/hue.h"
#include "image/image_plane.h"
#include "palpate/core/error.h"
#include "phase/surface_doubt.h"
#include "phase/unmixing.h"
#include "regions/phase_offset.h"
#include "regions/surface_pieces.h"

namespace palpate::sensing {
namespace {

/// Side of the tiles into which surfaces are divided: this part of a period, at least kLeastTile
/// [px].
constexpr double kTilePart = 1.0 / 8;
constexpr long kLeastTile = 4;
/// Largest distance of an anchor from the region that takes it, as part of a period. Over this
/// distance, the phase of one surface changes by less than half a turn, so it is rounded correctly.
constexpr double kAnchorReach = 1.0 / 4;

/// If the sinusoid hardly shows steps, regions with anchors must hold this part of the phases. A
/// plaster relief holds 0.79, spheres and squares alone 0.84; where objects of real captures were
/// one region with the wall behind them, all together held 0.59.
constexpr double kWhole = 0.7;

/// The phases at the anchors, at the nearest pixels of regions; `edge` is the number of the anchor.
void find_anchors(const DecoderGeometry& model, const DemodulationFilter& filter,
                  const DecodeOptions& options, Workspace& work) {
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
    const auto near =
        nearest_in_region(work.regions, guess, std::lround(filter.period() * kAnchorReach));
    if (near) work.guesses.push_back(*near);
  }
}

/// The depth at an anchor if another one is right [mm]; NaN if the projector cannot light it.
double depth_by(const DecoderGeometry& model, const PhaseGuess& anchor, const PhaseGuess& other,
                const Workspace& work) {
  const Plane& unwrapped = work.regions.phase;
  const auto place = [&](const PhaseGuess& at) {
    return static_cast<double>(unwrapped(at.row, at.column));
  };
  const double turns = std::round((other.phase - place(other)) / kFullTurn);
  Plane phase = Plane::Constant(unwrapped.rows(), unwrapped.cols(), kUnknown);
  phase(anchor.row, anchor.column) = static_cast<float>(place(anchor) + kFullTurn * turns);
  SurfaceImages surfaces;
  ReasonImage reasons = ReasonImage::Zero(phase.rows(), phase.cols());
  model.find_surfaces(phase, work.combined.shares, std::numeric_limits<double>::infinity(),
                      surfaces, reasons);
  return static_cast<double>(surfaces.z(anchor.row, anchor.column));
}

void refuse_contradiction(const DecoderGeometry& model, const DecodeOptions& options,
                          const Workspace& work) {
  const auto pair = contradicting_anchors(work.regions, work.guesses);
  if (!pair) return;
  const auto anchor = [&](const PhaseGuess& guess) -> const Anchor& {
    return options.anchors[static_cast<std::size_t>(guess.edge)];
  };
  const auto name = [&](const PhaseGuess& guess) {
    const Anchor& at = anchor(guess);
    return fmt::format("{:g},{:g},{:g}", at.u_px, at.v_px, at.z);
  };
  const auto remedy = [&](const PhaseGuess& right, const PhaseGuess& wrong) {
    const double z = depth_by(model, wrong, right, work);
    const std::string depth = std::isnan(z) ? "outside the depths that the projector can light"
                                            : fmt::format("at {:.1f} mm", z);
    return fmt::format("if {} is right, pixel {:g},{:g} is {}", name(right), anchor(wrong).u_px,
                       anchor(wrong).v_px, depth);
  };
  throw InvalidInput(fmt::format(
      "the anchors {} and {} contradict each other: they are on one smooth surface, but their "
      "depths differ by {} period{} of the sinusoid; {}; {}. Measure both again, or leave one out",
      name(pair->first), name(pair->second), pair->periods, pair->periods == 1 ? "" : "s",
      remedy(pair->first, pair->second), remedy(pair->second, pair->first)));
}

/// Returns true if regions with offsets hold most of the phases.
bool are_nearly_all(const Workspace& work) {
  long known = 0, anchored = 0;
  for (long i = 0; i < work.modulated.size(); ++i) {
    if (work.modulated.data()[i] == 0) continue;
    ++known;
    const int region = work.regions.label.data()[i];
    if (region >= 0 && work.offsets[static_cast<std::size_t>(region)].phase) ++anchored;
  }
  return static_cast<double>(anchored) >= kWhole * static_cast<double>(known);
}

}  // namespace

void cut_at_steps(const DecoderGeometry& whole, const DemodulationFilter& filter,
                  const DecodeOptions& options, bool steps_show, Workspace& work) {
  DemodulationFilter narrow = filter;
  narrow.averages = 1;
  Demodulation demodulated;
  Combined sharp;
  demodulate(work.channels, work.lit, narrow, demodulated);
  unmix(whole.rig().color_mixing, demodulated.channels);
  combine_channels(demodulated.channels, work.model(whole).chromatic(), sharp);
  SurfaceDoubt doubt;
  find_surface_doubt({.channels = work.demodulated.channels,
                      .combined = work.combined,
                      .sharp = sharp,
                      .wrapped = work.wrapped,
                      .variance = work.variance},
                     filter, {.max_variance = options.max_phase_variance, .steps_show = steps_show},
                     doubt);
  // A piece below the square of a period is smaller than the window of its phase.
  const double period = filter.period();
  cut_into_pieces(doubt, std::max(kLeastTile, std::lround(period * kTilePart)),
                  std::lround(period * period), work.variance);
}

void anchor_regions(const DecoderGeometry& whole, const DemodulationFilter& filter,
                    const DecodeOptions& options, bool steps_show, Workspace& work) {
  const DecoderGeometry& model = work.model(whole);
  find_anchors(model, filter, options, work);
  refuse_contradiction(model, options, work);
  anchored_offsets(work.regions, work.guesses, work.offsets);
  if (steps_show || are_nearly_all(work)) return;
  for (RegionOffset& offset : work.offsets) {
    if (offset.phase) offset = {{}, Reason::ambiguous_offset};
  }
}

}  // namespace palpate::sensing
