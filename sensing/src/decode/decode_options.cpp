// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/decode_options.h"

#include <numbers>

#include "palpate/error.h"
#include "palpate/require.h"

namespace palpate::sensing {

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

}  // namespace palpate::sensing
