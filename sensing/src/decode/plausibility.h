// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "colors/hue_classifier.h"
#include "image/image_plane.h"

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
    return table_[static_cast<std::size_t>(entry(pixel))];
  }
  /// The same in two steps; any entry for NaN.
  [[nodiscard]] int entry(float pixel) const {
    const float wanted = (pixel - first_) * kEntriesPerPixel;
    const float below = wanted < last_ ? wanted : last_;
    return static_cast<int>(below > 0 ? below : 0);
  }
  [[nodiscard]] const int* color_of_entries() const { return table_.data(); }

 private:
  static constexpr int kEntriesPerPixel = 4;
  float first_ = 0;  ///< projector pixel of the table's first entry
  float last_ = 0;   ///< the table's last entry
  std::vector<int> table_;
};

/// Marks the pixels around which the stripe colours contradict the depths: among the pixels nearby
/// that are well inside a stripe, less than `min_agreement` have the hue of the stripe that their
/// depth implies.
/// \param stripe_pixel projector pixel across the stripes that the depth implies; NaN if unknown.
/// \param nearby half width [px] of the square that counts as nearby.
void find_contradictions(const Plane& stripe_pixel, const Plane& hue, const StripeColors& stripes,
                         const HueClassifier& classifier, double min_agreement, long nearby,
                         Mask& marked);

}  // namespace palpate::sensing
