// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/sensing/decode.h"
#include "scene.h"

namespace palpate::bench {

/// Results over all views of a scene.
struct Figures {
  double median = 0;    ///< [%] of the distance: absolute error of the counted pixels ...
  double rms = 0;       ///< [%] ... and its root mean square, without pixels that are off
  double complete = 0;  ///< [%] of the counted pixels, those with a depth
  /// [%] of the counted pixels more than kAtStep from a depth step, those with a depth
  double complete_away = 0;
  /// [%] of all pixels with a depth, those more than half a period of the pattern from the truth,
  /// or where nothing is
  double off = 0;
  double off_away = 0;  ///< [%] the same, only pixels more than kAtStep from a depth step
  double ms = 0;        ///< [ms] processor time of one frame on one thread
};

/// [px] A pixel this close to a depth step sees both sides.
inline constexpr int kAtStep = 2;

/// Decodes every view. The time of a frame is the minimum of `repeats` runs, and the figure the
/// median over the views.
/// \param repeats > 0.
[[nodiscard]] Figures measure(const Scene& scene, const sensing::DecodeOptions& options,
                              int repeats);

}  // namespace palpate::bench
