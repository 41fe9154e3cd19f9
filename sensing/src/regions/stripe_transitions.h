// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "colors/hue_classifier.h"
#include "image/image_plane.h"

namespace palpate::sensing {

/// A boundary between two stripes, found on one scanline.
struct Transition {
  int row = 0;
  float column = 0;  ///< px, position of the hue change
  int edge = 0;      ///< index of the edge in the pattern
  float score = 0;   ///< ES of the thesis, divided by the windows' length: in [0, 2]
};

/// Maps each ordered pair of colours to the edge of the pattern between them.
class StripeEdges {
 public:
  explicit StripeEdges(const Pattern& pattern);
  /// Index of the edge, or -1.
  [[nodiscard]] int find(int left, int right) const {
    return edges_[static_cast<std::size_t>(left) * colors_ + static_cast<std::size_t>(right)];
  }

 private:
  std::size_t colors_;
  std::vector<int> edges_;
};

struct TransitionOptions {
  double min_hue_step = 0;     ///< [rad] see DecodeOptions
  int window_px = 0;           ///< see DecodeOptions
  double min_color_score = 0;  ///< see DecodeOptions
  bool reversed = false;       ///< the stripes follow each other from right to left
};

/// Finds and identifies the stripe transitions on all scanlines (thesis 3.3.2). Consecutive pixels
/// with a fast change of hue form one transition. Two windows of equal length, one on either side,
/// classify its colours; they are shorter than `window_px` in narrow stripes.
/// \param hue [rad], in [0, 2 pi).
void find_transitions(const Plane& hue, const Mask& lit, const StripeEdges& edges,
                      const HueClassifier& classifier, const TransitionOptions& options,
                      std::vector<Transition>& transitions);

}  // namespace palpate::sensing
