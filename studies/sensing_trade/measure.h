// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/sensing/decode.h"
#include "scene.h"

namespace palpate::bench {

/// Results over all views of a scene, as `geometry::RangeMapScore` defines them. Measurable are the
/// lit pixels that face both lenses.
struct Figures {
  double median = 0;    ///< [%] of the distance: absolute error of the depths that are not wrong
  double rms = 0;       ///< [%] and its root mean square
  double coverage = 0;  ///< [%]
  double coverage_away = 0;  ///< [%] the same, only pixels more than kAtStep from a depth step
  double wrong = 0;          ///< [%] of all pixels with a depth
  double wrong_away = 0;     ///< [%] the same, only pixels more than kAtStep from a depth step
  /// Root mean square of error / predicted standard deviation of the depths that are not wrong: 1
  /// if the prediction is right.
  double score = 0;
  double ripple = 0;   ///< [%] of the distance, see SurfaceDetail
  double normals = 0;  ///< [degrees] see SurfaceDetail
  double ms = 0;       ///< [ms] processor time of one frame on one thread
};

/// [px] A pixel this close to a depth step sees both sides.
inline constexpr int kAtStep = 2;

/// Decodes every view. The time of a frame is the minimum of `repeats` runs, and the figure the
/// median over the views.
/// \param repeats > 0.
[[nodiscard]] Figures measure(const Scene& scene, const sensing::DecodeOptions& options,
                              int repeats);

}  // namespace palpate::bench
