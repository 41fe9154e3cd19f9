// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/decode_options.h"

#include <cmath>
#include <numbers>
#include <string>

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

}  // namespace

void check_options(const DecodeOptions& options) {
  require("DecodeOptions::window_periods", options.window_periods, at_least(1.25).at_most(8));
  require("DecodeOptions::min_signal", options.min_signal, above(0).below(1));
  require("DecodeOptions::min_modulation", options.min_modulation, above(0).below(1));
  require("DecodeOptions::max_phase_sigma", options.max_phase_sigma, above(0).finite(), "rad");
  require("DecodeOptions::min_hue_step", options.min_hue_step, above(0).below(std::numbers::pi),
          "rad");
  require("DecodeOptions::color_window_px", options.color_window_px, at_least(1), "px");
  require("DecodeOptions::min_color_score", options.min_color_score, above(0).below(1));
  require("DecodeOptions::max_phase_variance", options.max_phase_variance, above(0).finite(),
          "rad^2");
  require("DecodeOptions::max_phase_step", options.max_phase_step, above(0).below(std::numbers::pi),
          "rad");
  require("DecodeOptions::min_agreement", options.min_agreement, above(0.5).at_most(1));
  require("DecodeOptions::max_sensitivity", options.max_sensitivity, above(0).finite());
}

void check_anchors(const std::vector<Anchor>& anchors, const Pattern& pattern,
                   const geometry::Camera& camera) {
  const bool striped = !pattern.stripe_edges.empty();
  if (!striped && anchors.empty()) {
    throw InvalidInput(
        "pattern: has no stripes to find depths from; an anchor (a pixel and its depth) is needed");
  }
  if (striped && !anchors.empty()) {
    throw InvalidInput(
        "DecodeOptions: anchors: are for a pattern without stripes; with them, leave them out");
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
    throw InvalidInput(
        "DecodeOptions: half_resolution: a period of the sinusoid would have about " +
        std::to_string(period) + " px at half the frame's size; at least " +
        std::to_string(kLeastHalfPeriod) + " px are needed, decode at full size");
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
