// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"

namespace palpate::sensing {

/// How the sinusoid is expected to look in the camera image before anything is known of the scene.
struct Carrier {
  bool transposed = false;  ///< the sinusoid varies along image rows: work on the transposed image
  double along =
      0;  ///< [rad/px] in the direction in which it varies, down the working image; signed
  double across = 0;              ///< [rad/px] in the other direction; |across| <= |along|
  double z = 0;                   ///< depth about which this holds
  bool stripes_reversed = false;  ///< stripes follow each other from right to left
};

/// Averages over surfaces facing the camera, over the camera's image, and over the depths at which
/// the projector lights what the camera sees.
/// \throws InvalidInput if there is no such depth, or if the sinusoid's period is shorter than two
/// camera pixels or longer than the image.
[[nodiscard]] Carrier expected_carrier(const Rig& rig, const Pattern& pattern);

}  // namespace palpate::sensing
