// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "palpate/geometry/range_map.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"

namespace palpate::sensing {

/// Finds the colour of the surface in a frame that shows it under the pattern, without stripes and
/// fringes: as the camera would see it under white light of the sinusoid's mean brightness. The
/// projector's shading (distance, angle of incidence) stays.
///
/// Every depth determines the projector pixel that lights it, and thus the sinusoid's angle a and
/// the stripe there. In windows of a period, least squares fit I = M + C cos a + S sin a, so blur
/// and colour channels that lag behind need not be known, and I M / (M + C cos a + S sin a) has no
/// fringes. A stripe lights only some channels. Over the width of some stripes the others are
/// interpolated where they are lit; the ratio of the lit values to these gives brightness at full
/// resolution. So brightness has the resolution of the camera, and colour that of the stripes.
/// \param frame  8 or 16 bit, linear in the light, 1 or 3 channels (BGR), of the camera's size.
/// \param range  decoded from this frame with this rig and pattern.
/// \return float in [0, 1], linear in the light, with the frame's channels; 0 where the depth is
/// unknown.
/// \throws InvalidInput if rig or pattern are not valid, or frame and range map have another size
/// or type than the rig's camera.
[[nodiscard]] cv::Mat surface_color(const cv::Mat& frame, const geometry::RangeMap& range,
                                    const Rig& rig, const Pattern& pattern);

/// Converts values that are linear in the light to 8 bit for screens (the curve of sRGB).
[[nodiscard]] cv::Mat srgb_of(const cv::Mat& linear);

}  // namespace palpate::sensing
