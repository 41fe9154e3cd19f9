// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/decode.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "colors/hue_classifier.h"
#include "decode/anchored_regions.h"
#include "decode/color_evidence.h"
#include "decode/decode_options.h"
#include "decode/decoder_geometry.h"
#include "decode/delivery.h"
#include "decode/evidence.h"
#include "decode/hidden_steps.h"
#include "decode/plausibility.h"
#include "decode/rig_deviation.h"
#include "decode/sharp_edges.h"
#include "decode/tinted_surfaces.h"
#include "decode/workspace.h"
#include "image/half_size.h"
#include "image/hot_loop.h"
#include "image/hue.h"
#include "image/image_part.h"
#include "image/image_plane.h"
#include "image/pool.h"
#include "image/reasons.h"
#include "palpate/core/error.h"
#include "phase/demodulation.h"
#include "phase/edge_blur.h"
#include "phase/modulation.h"
#include "phase/neighbour_mixing.h"
#include "phase/phase_noise.h"
#include "phase/texture_error.h"
#include "phase/unmixing.h"
#include "phase/wrapped_phase.h"
#include "regions/phase_seams.h"
#include "regions/snakes.h"
#include "regions/stripe_transitions.h"
#include "setup/baseline.h"

namespace palpate::sensing {
namespace {

/// Known neighbours whose phases differ by more than this belong to different surfaces [rad];
/// wrapped differences can show at most pi.
constexpr double kBreak = 2;
/// Slope of a surface's phase without the carrier [rad/px]: more between two pixels is a step.
constexpr double kSteepestPhase = 0.2;
/// Standard deviation of the phase [rad] beyond which a pixel beside a step sees both sides.
constexpr double kMisfit = 0.15;
/// Reach of blur beyond the edge of a surface [px].
constexpr int kBlurRadius = 2;
/// Half-widths of the squares in which colours are checked [px]: one with more than one stripe, and
/// one small enough that the surroundings of a narrow part of a surface do not outvote it.
constexpr std::array<long, 2> kNearby{16, 6};
/// Half the width of a trough of the sinusoid, including its flanks [px].
int trough_radius(const Carrier& carrier) { return (static_cast<int>(carrier.period()) + 1) / 2; }

/// Assigns to each pixel the entry of its label.
PALPATE_HOT_LOOP void add_entries(const int* label, const float* in, const float* to_add,
                                  const int* reason, float* __restrict phase,
                                  std::uint8_t* __restrict reasons, long pixels) {
  for (long i = 0; i < pixels; ++i) {
    phase[i] = in[i] + to_add[label[i]];
    const int given = reason[label[i]];
    reasons[i] = reasons[i] != 0 ? reasons[i] : static_cast<std::uint8_t>(given);
  }
}

/// Adds its offset to each region, and sets the reason of pixels in unresolved or no regions.
void add_offsets(const Regions& regions, const std::vector<RegionOffset>& offsets, Plane& phase,
                 ReasonImage& reasons) {
  phase.resize(regions.phase.rows(), regions.phase.cols());
  // One more entry before those of the regions, for pixels in no region, whose label is -1.
  std::vector<float> to_add(1, kUnknown);
  std::vector<int> reason(1, code(Reason::uneven_phase));
  for (const RegionOffset& offset : offsets) {
    to_add.push_back(offset.phase ? static_cast<float>(*offset.phase) : kUnknown);
    reason.push_back(code(offset.reason));
  }
  add_entries(regions.label.data(), regions.phase.data(), to_add.data() + 1, reason.data() + 1,
              phase.data(), reasons.data(), phase.size());
}

/// Converts deviations of phases to deviations of known depths.
PALPATE_HOT_LOOP void scale_sigma(const float* z, const float* z_per_phase, float* __restrict sigma,
                                  long pixels) {
  for (long i = 0; i < pixels; ++i) sigma[i] = z[i] == z[i] ? sigma[i] * z_per_phase[i] : kUnknown;
}

}  // namespace

struct Decoder::Impl {
  /// Additional data of a pattern with stripes.
  struct Stripes {
    Stripes(const DecoderGeometry& model, const TrainedColors& trained)
        : classifier(model.pattern(), trained),
          edges(model.pattern()),
          colors(model.pattern()),
          tinted(model, classifier),
          evidence(model, trained) {}
    HueClassifier classifier;
    StripeEdges edges;
    StripeColors colors;
    TintedSurfaces tinted;
    EvidenceFinder evidence;
  };

  Impl(const Rig& rig, const Pattern& pattern, const TrainedColors& colors,
       const DecodeOptions& the_options);

  void check_frame(const cv::Mat& frame) const;
  void find_part(const cv::Mat& frame, Workspace& work) const;
  void demodulate_part(Workspace& work) const;
  void judge_light(Workspace& work) const;
  void find_regions(Workspace& work) const;
  void predict_sigma(Workspace& work) const;
  void find_guesses(Workspace& work) const;
  void drop_borders(Workspace& work) const;
  void check_colors(Workspace& work) const;
  void fill_result(Workspace& work, DecodeResult& result) const;
  void decode(const cv::Mat& frame, DecodeResult& result) const;

  DecodeOptions options;
  geometry::Camera camera;  ///< of the frames
  DecoderGeometry model;    ///< of the decoded image
  RigDeviation rig_deviation;
  DemodulationFilter filter;
  std::optional<Stripes> stripes;  ///< if the pattern has any
  bool steps_show;                 ///< under the sinusoid alone
  mutable Pool<Workspace> workspaces;
};

Decoder::Impl::Impl(const Rig& rig, const Pattern& pattern, const TrainedColors& colors,
                    const DecodeOptions& the_options)
    : options(in_range(the_options)),
      camera(rig.camera),
      model(decoded_rig(rig, pattern, options.half_resolution), pattern),
      rig_deviation(model.rig(), pattern.axis, model.carrier(), model.rows(), model.columns()),
      filter(make_filter(model.carrier().along, options.window_periods)),
      steps_show(shows_steps(rig, pattern.axis)) {
  check_pattern_fits(pattern, rig.projector, "pattern");
  geometry::Camera seen = rig.camera;
  if (options.half_resolution) {
    seen.width = 2 * model.rig().camera.width;
    seen.height = 2 * model.rig().camera.height;
  }
  check_anchors(options.anchors, pattern, seen);
  if (!pattern.stripe_edges.empty()) stripes.emplace(model, colors);
}

void Decoder::Impl::check_frame(const cv::Mat& frame) const {
  if (frame.cols != camera.width || frame.rows != camera.height) {
    throw InvalidInput("frame: is " + std::to_string(frame.cols) + " x " +
                       std::to_string(frame.rows) + " px, the rig's camera has " +
                       std::to_string(camera.width) + " x " + std::to_string(camera.height));
  }
  if (stripes && frame.channels() != 3) {
    throw InvalidInput("frame: has " + std::to_string(frame.channels()) +
                       (frame.channels() == 1 ? " channel" : " channels") +
                       "; the pattern's coloured stripes need three");
  }
}

void Decoder::Impl::find_guesses(Workspace& work) const {
  const std::vector<Demodulated>& green_red_blue = work.demodulated.channels;
  find_hues(green_red_blue[1].mean, green_red_blue[0].mean, green_red_blue[2].mean, work.hue);
  find_transitions(work.hue, work.lit, stripes->edges, stripes->classifier,
                   {.min_hue_step = options.min_hue_step,
                    .window_px = options.color_window_px,
                    .min_color_score = options.min_color_score,
                    .reversed = model.carrier().stripes_reversed},
                   work.transitions);
  work.model(model).phases_at_edges(work.transitions, work.guesses);
}

/// Finds the lit part of the frame, with a margin in which windows and anchors reach it.
void Decoder::Impl::find_part(const cv::Mat& frame, Workspace& work) const {
  if (options.half_resolution) {
    split_frame(frame, model.carrier().transposed, work.full_size);
    half_size(work.full_size, work.image);
  } else {
    split_frame(frame, model.carrier().transposed, work.image);
  }
  find_lit(work.image,
           {.colored = stripes.has_value(),
            .radius = trough_radius(model.carrier()),
            .min_signal = options.min_signal},
           work.image_lit);
  work.part = lit_part(work.image_lit, filter.radius);
  if (work.part.is_whole(work.image_lit)) {
    work.part_model.reset();
    work.channels.swap(work.image);
    work.lit.swap(work.image_lit);
    return;
  }
  work.part_model.emplace(model, work.part);
  work.channels.resize(work.image.size());
  for (std::size_t i = 0; i < work.image.size(); ++i)
    work.channels[i] = part_of(work.image[i], work.part);
  work.lit = part_of(work.image_lit, work.part);
}

/// Finds the sinusoid in the part.
void Decoder::Impl::demodulate_part(Workspace& work) const {
  demodulate(work.channels, work.lit, filter, work.demodulated);
  unmix(model.rig().color_mixing, work.demodulated.channels);
  combine_channels(work.demodulated.channels, work.model(model).chromatic(), work.combined);
}

/// Finds the pixels with enough light, and a sinusoid that is strong enough for the noise.
void Decoder::Impl::judge_light(Workspace& work) const {
  find_modulated(work.combined, work.lit, options.min_modulation, work.modulated);
  find_wrapped_phase(work.combined.re, work.combined.im, work.wrapped);
  const PhaseSignal signal{.wrapped = work.wrapped,
                           .combined = work.combined,
                           .channels = work.demodulated.channels,
                           .residual = work.demodulated.residual,
                           .modulated = work.modulated};
  predict_phase_sigma(signal, estimate_noise(signal, filter), filter, work.sigma);
  unmix_neighbours(signal, filter, work.wrapped, work.sigma);
  add_edge_blur(work.lit, filter, work.sigma);
  drop_uncertain(work.sigma, options.max_phase_sigma, work.modulated);
  work.reasons.setZero(work.part.rows, work.part.columns);
  find_clipped(work.channels, work.clipped);
  work.clipped *= 1 - work.modulated;
  give_reason(work.clipped, Reason::saturated, work.reasons);
  give_reason_unless(work.lit, Reason::unlit, work.reasons);
  give_reason_unless(work.modulated, Reason::low_modulation, work.reasons);
}

/// Unwraps the phase and makes it absolute.
void Decoder::Impl::find_regions(Workspace& work) const {
  const FloodLimits limits{.max_variance = options.max_phase_variance,
                           .max_step = options.max_phase_step};
  phase_variance(work.wrapped, work.modulated, work.variance);
  if (!stripes) cut_at_steps(model, filter, options, steps_show, work);
  const bool snakes = options.segmentation == Segmentation::snakes;
  if (snakes) {
    grow_snakes(work.wrapped, work.variance, limits, work.regions);
  } else {
    grow_regions(work.wrapped, work.variance, limits, work.unwrapping, work.regions);
  }
  if (stripes) {
    find_guesses(work);
    if (!snakes) {
      find_markers(work.regions, work.guesses, work.voting, work.markers);
      split_regions(work.wrapped, work.variance, limits, work.markers, work.unwrapping,
                    work.regions);
    }
    region_offsets(work.regions, work.guesses, options.min_agreement, work.voting, work.offsets);
    solve_from_neighbours(work.regions,
                          {.min_width = snakes ? 0 : 1,
                           .max_width = filter.radius - 1,  // a period is `radius` long
                           .min_agreement = options.min_agreement},
                          work.offsets);
    stripes->tinted.solve(work.demodulated.channels, work.hue, stripes->classifier, stripes->colors,
                          work.model(model), {filter.radius, filter.width() / 2}, work.regions,
                          work.offsets, work.tinted);
  } else {
    anchor_regions(model, filter, options, steps_show, work);
  }
  add_offsets(work.regions, work.offsets, work.phase, work.reasons);
}

/// Removes the phases of windows that mix two surfaces, or a surface and the dark beside it.
void Decoder::Impl::drop_borders(Workspace& work) const {
  if (stripes) {
    find_hidden_steps(work.demodulated.channels, work.phase, work.hue, stripes->classifier,
                      stripes->colors, work.model(model), work.either_surface);
  }
  bridge_gaps(work.lit, work.phase, kBlurRadius, kBreak, work.breaks);
  erode(work.breaks, kBlurRadius, work.inner);
  keep_sharp_edges(work.demodulated.channels, work.breaks, kBlurRadius, work.inner);
  give_reason_unless(work.inner, Reason::border, work.reasons);
  keep_reconstructed(work.reasons, work.phase);
  // Across the sinusoid, two standard deviations of the average along the rows.
  const Reach reach{filter.radius / 2,
                    static_cast<int>(std::lround(2 * std::sqrt(filter.row_variance())))};
  find_breaks(work.phase, kBreak, reach, work.breaks);
  give_reason(work.breaks, Reason::border, work.reasons);
  keep_reconstructed(work.reasons, work.phase);
  // Beside a depth step a sinusoid that fits badly belongs to both surfaces.
  find_steps(work.phase,
             {.step = kBreak, .slope = kSteepestPhase, .gap = {2 * filter.radius, filter.radius}},
             reach, work.breaks);
  keep_above(work.sigma, kMisfit, work.breaks);
  give_reason(work.breaks, Reason::border, work.reasons);
  if (stripes) give_reason(work.either_surface, Reason::border, work.reasons);
  keep_reconstructed(work.reasons, work.phase);
}

/// Completes the standard deviation of the phase, and converts it to that of the depth.
void Decoder::Impl::predict_sigma(Workspace& work) const {
  const Pattern& pattern = model.pattern();
  const PixelOfPhase pixels{.along = model.carrier().along,
                            .offset = pattern.phase,
                            .per_pixel = kFullTurn / pattern.period};
  add_chromatic_error(work.combined.shares,
                      remaining_error(work.demodulated.channels, work.model(model).chromatic(),
                                      work.phase, pixels, PhaseTexture::disturbs),
                      work.sigma);
  add_texture_error(work.demodulated.channels, work.combined, filter, work.sigma);
  scale_sigma(work.surfaces.z.data(), work.surfaces.z_per_phase.data(), work.sigma.data(),
              work.sigma.size());
  if (rig_deviation.is_known())
    rig_deviation.add(work.surfaces.z, work.part, work.sigma, work.noise);
}

/// Removes the depths that the colours contradict.
void Decoder::Impl::check_colors(Workspace& work) const {
  const TintedSurfaces::Seen& tinted = work.tinted;
  if (tinted.any) {
    work.corrected_hue = work.hue;
    stripes->tinted.correct_hues(tinted, work.surfaces.stripe_pixel, stripes->colors,
                                 work.corrected_hue);
  }
  const Plane& hue = tinted.any ? work.corrected_hue : work.hue;
  compare_colors(work.surfaces.stripe_pixel, hue, stripes->colors, stripes->classifier, work.says);
  for (const long nearby : kNearby) {
    find_contradictions(work.surfaces.stripe_pixel, work.says, options.min_agreement, nearby,
                        work.contradicting);
    give_reason(work.contradicting, Reason::color_mismatch, work.reasons);
  }
  keep_reconstructed(work.reasons, work.surfaces.z);
  find_unproven_patches(work.surfaces.z, work.says, stripes->classifier.colors(),
                        work.contradicting);
  // A surface that reflects one channel shows one colour; other evidence proves its regions.
  if (tinted.any) work.contradicting *= 1 - tinted.single;
  give_reason(work.contradicting, Reason::color_mismatch, work.reasons);
  keep_reconstructed(work.reasons, work.surfaces.z);
}

/// Moves the result's former images to the workspace for reuse.
void Decoder::Impl::fill_result(Workspace& work, DecodeResult& result) const {
  result.evidence = stripes ? stripes->evidence.find(work, model) : DecodeEvidence{};
  result.transitions = stripes ? static_cast<int>(work.guesses.size()) : 0;
  result.regions = work.regions.count;
  result.unresolved_regions =
      static_cast<int>(std::count_if(work.offsets.begin(), work.offsets.end(),
                                     [](const RegionOffset& offset) { return !offset.phase; }));
  result.range.camera = model.rig().camera;
  if (work.part_model) find_reasons_around(work);
  const bool transposed = model.carrier().transposed;
  const auto deliver_plane = [&](Plane& image, Plane& to) {
    deliver(image, work, Plane::Constant(model.rows(), model.columns(), kUnknown), transposed, to);
  };
  deliver_plane(work.surfaces.z, result.range.z);
  deliver(work.reasons, work, work.reasons_around, transposed, result.reasons);
  deliver_plane(work.sigma, result.sigma);
  if (rig_deviation.is_known()) {
    deliver_plane(work.noise, result.noise);
  } else {
    result.noise.resize(0, 0);
  }
}

void Decoder::Impl::decode(const cv::Mat& frame, DecodeResult& result) const {
  check_frame(frame);
  const auto work = workspaces.borrow();
  find_part(frame, *work);
  demodulate_part(*work);
  judge_light(*work);
  find_regions(*work);
  drop_borders(*work);
  work->model(model).find_surfaces(work->phase, work->combined.shares, options.max_sensitivity,
                                   work->surfaces, work->reasons);
  if (stripes) check_colors(*work);
  predict_sigma(*work);
  fill_result(*work, result);
}

Decoder::Decoder(const Rig& rig, const Pattern& pattern, const TrainedColors& colors,
                 const DecodeOptions& options)
    : impl_(std::make_unique<Impl>(rig, pattern, colors, options)) {}
Decoder::~Decoder() = default;
Decoder::Decoder(Decoder&&) noexcept = default;
Decoder& Decoder::operator=(Decoder&&) noexcept = default;

const Rig& Decoder::rig() const { return impl_->model.rig(); }

DecodeResult Decoder::decode(const cv::Mat& frame) const {
  DecodeResult result;
  decode(frame, result);
  return result;
}

void Decoder::decode(const cv::Mat& frame, DecodeResult& result) const {
  impl_->decode(frame, result);
}

}  // namespace palpate::sensing
