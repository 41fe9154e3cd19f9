// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "palpate/geometry/range_map.h"

namespace palpate::geometry {

/// Noise of the depths of a camera: the standard deviation at depth z is constant + quadratic z^2.
/// Time-of-flight cameras mostly have the first part, triangulation mostly the second.
struct DepthNoise {
  double constant = 0;   ///< [mm] >= 0
  double quadratic = 0;  ///< [1 / mm] >= 0

  [[nodiscard]] double deviation(double z) const { return constant + quadratic * z * z; }
};

/// Least number of frames that `depth_noise` needs.
inline constexpr int kStillFrames = 4;

/// The noise of a camera, from frames of a scene that does not move: how much the depths of a pixel
/// differ from each other. Pixels that differ far more than others at their depth, as at the border
/// of objects, do not count. Errors that all frames have in common, such as a wrong calibration,
/// are not noise.
/// \param still [mm] depths of each frame; a depth that is not > 0 is unknown.
/// \param resolution [mm] step of the depths; noise is at least that of rounding to it.
/// \throws InvalidInput if there are fewer than kStillFrames frames, they differ in size, too few
/// pixels are known in all of them, or the depths drift from frame to frame: something moves.
[[nodiscard]] DepthNoise depth_noise(std::span<const ImageF> still, double resolution = 0);

/// [mm] The standard deviation of each depth, for `smooth_range_map`; NaN where it is unknown.
[[nodiscard]] ImageF deviations(const DepthNoise& noise, const ImageF& z);

}  // namespace palpate::geometry
