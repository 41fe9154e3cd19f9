// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/anchored_regions.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "image/half_size.h"
#include "image/hue.h"
#include "image/image_plane.h"
#include "palpate/core/error.h"
#include "regions/phase_offset.h"
#include "regions/unwrapping.h"

namespace palpate::sensing {
namespace {

/// Smallest part of a region that must hold an anchor of its own [px].
constexpr int kLeastAnchoredCore = 50;
/// Standard deviation of the phase [rad] beyond which an anchored region ends. Steps of depth have
/// more; relief under a coarse sinusoid, whose shading does not fit it, has up to about 0.1.
constexpr double kAnchoredSigma = 0.15;

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
    const auto near = nearest_in_region(work.regions, guess, filter.radius);
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

/// \param connected numbers the surfaces that are smooth all over.
void refuse_contradiction(const DecoderGeometry& model, const Labels& connected,
                          const DecodeOptions& options, const Workspace& work) {
  const auto pair = contradicting_anchors(work.regions, connected, work.guesses);
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

}  // namespace

void anchor_regions(const DecoderGeometry& whole, const DemodulationFilter& filter,
                    const DecodeOptions& options, Workspace& work) {
  const DecoderGeometry& model = work.model(whole);
  find_anchors(model, filter, options, work);
  if (options.segmentation == Segmentation::flood) {
    anchor_markers(work.regions, work.guesses, work.markers);
    work.doubt = work.variance + work.sigma.square();
    split_regions(work.wrapped, work.doubt,
                  {.max_variance = options.max_phase_variance + kAnchoredSigma * kAnchoredSigma,
                   .max_step = options.max_phase_step,
                   .least_core = kLeastAnchoredCore},
                  work.markers, work.unwrapping, work.regions);
    refuse_contradiction(model, work.unwrapping.cores, options, work);
  } else {
    refuse_contradiction(model, work.regions.label, options, work);
  }
  anchored_offsets(work.regions, work.guesses, work.offsets);
}

}  // namespace palpate::sensing
