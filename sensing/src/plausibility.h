// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "hue_classifier.h"
#include "planes.h"

namespace palpate::sensing {

/// The pixels of a mask of which all others at most `radius` rows and columns away belong to it
/// too; the image's border does no harm. What is cut away is where blur carries light beyond the
/// edge of a surface.
void erode(const Mask& mask, int radius, Mask& inner);

/// How far a break of the phase reaches: the window of the demodulation mixes both sides.
struct Reach {
  int rows = 0;     ///< px, along the sinusoid
  int columns = 0;  ///< px
};

/// Marks the pixels within reach of a break: two neighbours whose absolute phases differ by more
/// than `max_step` [rad]. A phase of NaN breaks nothing.
void find_breaks(const Plane& phase, double max_step, const Reach& reach, Mask& marked);

/// The colour that a projector pixel has well inside a stripe.
class StripeColors {
 public:
  explicit StripeColors(const Pattern& pattern);
  /// Index of the colour, or -1 near an edge.
  /// \param pixel across the stripes; finite.
  [[nodiscard]] int color(float pixel) const {
    const auto last = static_cast<float>(table_.size() - 1);
    const float entry = (pixel - first_) * kEntriesPerPixel;
    const float inside = entry < last ? entry : last;
    return table_[static_cast<std::size_t>(static_cast<int>(inside > 0 ? inside : 0))];
  }

 private:
  static constexpr int kEntriesPerPixel = 4;
  float first_ = 0;  ///< projector pixel of the table's first entry
  std::vector<int> table_;
};

/// Marks the pixels around which the stripe colours contradict the depths: among the pixels nearby
/// that are well inside a stripe, less than `min_agreement` have the hue of the stripe that their
/// depth implies.
/// \param stripe_pixel projector pixel across the stripes that the depth implies; NaN if unknown.
void find_contradictions(const Plane& stripe_pixel, const Plane& hue, const StripeColors& stripes,
                         const HueClassifier& classifier, double min_agreement, Mask& marked);

}  // namespace palpate::sensing
