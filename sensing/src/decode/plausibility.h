// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "colors/hue_classifier.h"
#include "image/image_plane.h"

namespace palpate::sensing {

/// Erodes a mask: keeps the pixels for which all others within `radius` rows and columns belong to
/// it; the image's border does not erode. This removes the pixels that blur lights beyond the edge
/// of a surface.
void erode(const Mask& mask, int radius, Mask& inner);

/// Adds to a mask the gaps of at most `width` pixels in its rows across which a surface continues:
/// the phases beside the gap are known, and differ by at most `max_step` [rad]. In little light,
/// the edges between stripes are such gaps.
void bridge_gaps(const Mask& mask, const Plane& phase, long width, double max_step, Mask& bridged);

/// Reach of a phase discontinuity: the demodulation window mixes both sides.
struct Reach {
  int rows = 0;     ///< px, along the sinusoid
  int columns = 0;  ///< px
};

/// Marks the pixels within reach of a discontinuity: two neighbours whose absolute phases differ by
/// more than `max_step` [rad]. NaN is no discontinuity.
void find_breaks(const Plane& phase, double max_step, const Reach& reach, Mask& marked);

/// Two pixels with a phase, at most `gap` apart in a row or a column and with none in between, lie
/// on different surfaces if their phases differ by more than step + slope * distance [rad].
struct StepLimits {
  double step = 0;   ///< [rad]
  double slope = 0;  ///< [rad/px]
  Reach gap;
};
/// Marks the pixels within `reach` of both sides of each step, also across pixels without a phase.
void find_steps(const Plane& phase, const StepLimits& limits, const Reach& reach, Mask& marked);

/// Keeps the marks of pixels whose value is > limit.
void keep_above(const Plane& values, double limit, Mask& marked);

/// Maps a projector pixel well inside a stripe to the stripe's colour.
class StripeColors {
 public:
  /// A pixel is well inside a stripe if it is this far from its edges [projector px]: farther than
  /// the blur of camera and projector and the lateral shift of their colour channels.
  static constexpr double kEdgeMargin = 4;

  /// \param margin used instead of kEdgeMargin.
  explicit StripeColors(const Pattern& pattern, double margin = kEdgeMargin);
  /// Index of the colour, or -1 near an edge.
  /// \param pixel across the stripes; finite.
  [[nodiscard]] int color(float pixel) const {
    return table_[static_cast<std::size_t>(entry(pixel))];
  }
  /// Index of a pixel's table entry; `color_of_entries()[entry(pixel)]` equals `color(pixel)`. Any
  /// entry for NaN.
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

/// Evidence of each pixel's colour for its depth: kSilent, or the index of the colour of the stripe
/// that the depth implies there, plus kConfirms if the pixel has the hue of that colour.
using ColorSays = Mask;
inline constexpr std::uint8_t kSilent = 255;  ///< no depth, or near the edge of a stripe
inline constexpr std::uint8_t kConfirms = 64;

/// \param stripe_pixel projector pixel across the stripes that the depth implies; NaN if unknown.
/// \param hue [rad]
void compare_colors(const Plane& stripe_pixel, const Plane& hue, const StripeColors& stripes,
                    const HueClassifier& classifier, ColorSays& says);

/// Marks the pixels around which the stripe colours contradict the depths: of the pixels nearby
/// whose colours are evidence, a share below `min_agreement` confirms the depth.
/// \param stripe_pixel as above; pixels where it is NaN are not marked.
/// \param nearby half-width [px] of the square of nearby pixels.
void find_contradictions(const Plane& stripe_pixel, const ColorSays& says, double min_agreement,
                         long nearby, Mask& marked);

}  // namespace palpate::sensing
