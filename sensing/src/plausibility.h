// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hue_classifier.h"
#include "planes.h"

namespace palpate::sensing {

/// The pixels of a mask whose eight neighbours belong to it too; the image's border does no harm.
/// What is cut away is where blur carries light beyond the edge of a surface.
[[nodiscard]] Mask eroded(const Mask& mask);

/// How far a break of the phase reaches: the window of the demodulation mixes both sides.
struct Reach {
  int rows = 0;     ///< px, along the sinusoid
  int columns = 0;  ///< px
};

/// Marks the pixels within reach of a break: two known neighbours whose absolute phases differ by
/// more than `max_step` [rad].
[[nodiscard]] Mask near_breaks(const Plane& phase, const Mask& known, double max_step,
                               const Reach& reach);

/// Marks the pixels around which the stripe colours contradict the depths: among the pixels nearby
/// that are well inside a stripe, less than `min_agreement` have the hue of the stripe that their
/// depth implies.
/// \param stripe_pixel projector pixel across the stripes that the depth implies; NaN if unknown.
[[nodiscard]] Mask contradicting_colors(const Plane& stripe_pixel, const Plane& hue,
                                        const Pattern& pattern, const HueClassifier& classifier,
                                        double min_agreement);

}  // namespace palpate::sensing
