// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/depth_score.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace palpate::apps {

Json score_figures(const geometry::RangeMapScore& score) {
  return {{"distance", score.distance},
          {"measurable", score.measurable},
          {"covered", score.covered},
          {"coverage", score.coverage},
          {"measured", score.measured},
          {"wrong", score.wrong},
          {"wrong_share", score.wrong_share},
          {"count", score.error.count},
          {"rms", score.error.rms},
          {"median", score.error.median},
          {"p90", score.error.p90},
          {"p95", score.error.p95},
          {"max", score.error.max},
          {"relative_rms", score.relative_error.rms},
          {"relative_median", score.relative_error.median}};
}

std::string score_prose(const geometry::RangeMapScore& score, const std::string& measurable) {
  std::string text;
  if (score.measurable > 0) {
    text += fmt::format("Coverage: {:.1f} % of the {} pixels {}.\n", 100 * score.coverage,
                        score.measurable, measurable);
  }
  if (score.measured > 0) {
    text += fmt::format(
        "Wrong: {:.2f} % of the {} measured pixels (more than {:.0f} % of the distance off, or no "
        "surface there).\n",
        100 * score.wrong_share, score.measured, 100 * geometry::kWrongDepth);
  }
  if (score.error.count == 0) return text + "No measured depth is right.";
  return text +
         fmt::format(
             "Error of the other {}: median {:.3f} mm = {:.4f} % of the distance, RMS {:.3f} mm = "
             "{:.4f} %, 90 % within {:.3f} mm, largest {:.3f} mm.",
             score.error.count, score.error.median, 100 * score.relative_error.median,
             score.error.rms, 100 * score.relative_error.rms, score.error.p90, score.error.max);
}

}  // namespace palpate::apps
