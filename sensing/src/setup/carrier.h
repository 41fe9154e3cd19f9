// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"

namespace palpate::sensing {

/// Points for evaluating a rig before anything is known of the scene: at kTriedDepths depths from
/// one to kFarthestBaselines baselines in equal ratios, and at kPlacesPerSide places along each
/// side of the camera image. Closer, the views do not overlap; farther, depth cannot be measured.
inline constexpr int kTriedDepths = 30;
inline constexpr double kFarthestBaselines = 20;
inline constexpr int kPlacesPerSide = 9;

/// Expected appearance of the sinusoid in the camera image before anything is known of the scene.
struct Carrier {
  bool transposed = false;  ///< the sinusoid varies along image rows: work on the transposed image
  double along = 0;   ///< [rad/px] frequency down the working image, the main direction; signed
  double across = 0;  ///< [rad/px] in the other direction; |across| <= |along|
  double z = 0;       ///< depth at which this holds
  bool stripes_reversed = false;  ///< the stripes follow each other from right to left

  /// Period of the sinusoid in the working image [px].
  [[nodiscard]] double period() const { return 2 * std::numbers::pi / std::abs(along); }
};

/// Predicts the carrier for surfaces facing the camera, averaged over the camera's image and over
/// the depths at which the projector lights the camera's view.
/// \throws InvalidInput if there is no such depth, or if the sinusoid's period is shorter than two
/// camera pixels or longer than the image.
[[nodiscard]] Carrier expected_carrier(const Rig& rig, const Pattern& pattern);

/// Mean width of a stripe in the working image [px]; a period if the pattern has fewer than three.
[[nodiscard]] double stripe_width(const Carrier& carrier, const Pattern& pattern);

}  // namespace palpate::sensing
