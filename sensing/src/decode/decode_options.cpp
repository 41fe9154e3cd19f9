// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/decode_options.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "decode/decoder_geometry.h"
#include "image/half_size.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::sensing {
namespace {

/// Smallest period at half size [px]. For longer periods the alias of the sinusoid at the negative
/// frequency is at least one carrier away, on a zero of the window's spectrum or beyond, like the
/// second harmonic. For shorter periods it would disturb the phase wherever a slope moves the
/// sinusoid off the carrier.
constexpr double kLeastHalfPeriod = 3;

constexpr std::array<std::string_view, 2> kSegmentations{"flood", "snakes"};
constexpr std::array<TableField::Column, 3> kAnchor{
    {{"u_px", finite()}, {"v_px", finite()}, {"z", above(0).finite()}}};

TableField::Rows rows_of(const std::vector<Anchor>& anchors) {
  TableField::Rows rows;
  for (const Anchor& anchor : anchors) rows.push_back({anchor.u_px, anchor.v_px, anchor.z});
  return rows;
}

std::vector<Anchor> anchors_of(const TableField::Rows& rows) {
  std::vector<Anchor> anchors;
  for (const std::vector<double>& row : rows) anchors.push_back({row[0], row[1], row[2]});
  return anchors;
}

}  // namespace

void visit(DecodeOptions& options, FieldVisitor& visitor) {
  constexpr double kPi = std::numbers::pi;
  visitor.begin("DecodeOptions");
  visitor.real({"window_periods",
                "Length of the demodulation window: a longer window has less noise, a shorter one "
                "resolves finer relief and measures closer to edges",
                "periods of the sinusoid"},
               options.window_periods, at_least(1.25).at_most(8));
  visitor.flag({"half_resolution",
                "Decode at half the size of the frames, which is several times faster; the range "
                "maps and their camera have that size, and the sinusoid needs 6 px per period"},
               options.half_resolution);
  visitor.choice(
      {"segmentation",
       "Method for finding smooth regions: flood, or snakes (thesis 3.3.4), which bridge "
       "gaps in the borders of regions but are slower"},
      options.segmentation, kSegmentations);
  visitor.table(
      {.name = "anchors",
       .description = "A pixel u,v whose depth z you know. A pattern without stripes needs one on "
                      "each surface, away from edges; other surfaces get no depths",
       .unit = "px, px, mm",
       .option = "anchor"},
      {rows_of(options.anchors), kAnchor,
       [&options](const TableField::Rows& rows) { options.anchors = anchors_of(rows); }});

  constexpr bool kExpert = true;
  visitor.real({"min_signal", "Least light of the projector at which a pixel counts as lit",
                "fraction of full scale", kExpert},
               options.min_signal, above(0).below(1));
  visitor.real({"min_modulation", "Least amplitude of the sinusoid at which a phase is used",
                "fraction of full scale", kExpert},
               options.min_modulation, above(0).below(1));
  visitor.real({"max_phase_sigma",
                "Largest standard deviation of a phase that is used, as the noise of the frame and "
                "the misfit of the sinusoid predict it",
                "rad of phase", kExpert},
               options.max_phase_sigma, above(0).finite());
  visitor.real({"min_hue_step", "Least change of the hue at a stripe edge", "rad/px", kExpert},
               options.min_hue_step, above(0).below(kPi));
  visitor.whole({"color_window_px",
                 "Pixels on each side of a stripe edge that classify its colours; fewer in narrow "
                 "stripes",
                 "px", kExpert},
                options.color_window_px, at_least(1));
  visitor.real({"min_color_score",
                "Least mean probability of its colour at which a side of a stripe edge is trusted",
                "", kExpert},
               options.min_color_score, above(0).below(1));
  visitor.real({"max_phase_variance",
                "Largest variance of the phases in the neighbourhood of a pixel that belongs to a "
                "smooth region",
                "rad^2", kExpert},
               options.max_phase_variance, above(0).finite());
  visitor.real(
      {"max_phase_step", "Largest change of the phase from a pixel to the next within a region",
       "rad/px", kExpert},
      options.max_phase_step, above(0).below(kPi));
  visitor.real({"min_agreement",
                "Least share of the stripe edges that must agree on a phase offset, and of the "
                "colours around a depth that must agree with it",
                "", kExpert},
               options.min_agreement, above(0.5).at_most(1));
  visitor.real(
      {"max_sensitivity", "Largest change of a depth with the phase, as a share of the depth",
       "1/rad", kExpert},
      options.max_sensitivity, above(0).finite());
}

void check_anchors(const std::vector<Anchor>& anchors, const Pattern& pattern,
                   const geometry::Camera& camera) {
  const bool striped = !pattern.stripe_edges.empty();
  if (!striped && anchors.empty()) {
    throw InvalidInput(
        "pattern: has no stripes to find depths from; an anchor (a pixel and its depth) is needed");
  }
  if (striped && !anchors.empty()) {
    throw InvalidInput(std::vector<MessagePart>{
        {"DecodeOptions::anchors", true},
        {": are for a pattern without stripes; this one has stripes, so leave them out"}});
  }
  for (const Anchor& anchor : anchors) {
    require("Anchor::u_px", anchor.u_px, above(-0.5).below(camera.width - 0.5), "px");
    require("Anchor::v_px", anchor.v_px, above(-0.5).below(camera.height - 0.5), "px");
    require("Anchor::z", anchor.z, above(0).finite(), "mm");
  }
}

Rig decoded_rig(const Rig& rig, const Pattern& pattern, bool half) {
  if (!half) return rig;
  check_rig(rig, "rig");
  check_pattern(pattern, "pattern");
  const double period = expected_carrier(rig, pattern).period() / 2;
  if (period < kLeastHalfPeriod) {
    throw InvalidInput(std::vector<MessagePart>{
        {"DecodeOptions::half_resolution", true},
        {": a period of the sinusoid would have about " + std::to_string(period) +
         " px at half the frame's size; at least " + std::to_string(kLeastHalfPeriod) +
         " px are needed, decode at full size"}});
  }
  Rig decoded = rig;
  decoded.camera = half_size(rig.camera);
  if (decoded.covariance) {
    // Of the camera's fx fy cx cy [px].
    decoded.covariance->topRows<4>() /= 2;
    decoded.covariance->leftCols<4>() /= 2;
  }
  return decoded;
}

}  // namespace palpate::sensing
