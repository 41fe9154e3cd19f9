// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"

namespace palpate::sensing {

/// How a pattern comes onto the projector's panel.
struct DrawOptions {
  /// false: straight on the panel. A decoder that knows the projector's pose and lens then sees
  /// exactly what the rig says: a stripe edge or a phase is one coordinate of the panel.
  /// true: bent so that it leaves the lens as from a projector without distortion whose axes are
  /// parallel to the camera's (thesis 3.2.2): Eqs. 3.2 and 3.11 hold, and on surfaces facing the
  /// camera the sinusoid has the same period all over the image.
  bool rectify = false;
  /// Stretches and shifts the red and the blue panel by the rig's beta and gamma (Eq. 3.13), so
  /// that all colours meet on the object.
  bool compensate = true;
  int bits = 8;  ///< a channel; 8 or 16
};

/// The rig that describes frames of a drawing. `rectify` replaces the projector by the parallel
/// one, at the same place and with the same focal lengths, whose panel holds all that the real one
/// shows; `compensate` leaves beta = 1 and gamma = 0, since these are taken care of (alpha, the
/// camera's, stays). With `rectify` alone the chromatic values hold only approximately: they belong
/// to the real panel.
/// \throws InvalidInput if the rig is not valid, or for `rectify` if the projector's lens cannot be
/// inverted on its panel, or light leaves it by more than 60 degrees from the camera's axis.
[[nodiscard]] Rig rig_of_drawing(const Rig& rig, const DrawOptions& options = {});

/// The picture for the projector's panel: linear in the light, BGR, of the projector's size. The
/// sinusoid has its value at the centre of each pixel; a stripe edge within a pixel mixes the two
/// colours in proportion.
/// \param pattern in pixels of `rig_of_drawing(rig, options).projector`.
/// \throws InvalidInput if pattern, rig or options are not valid.
[[nodiscard]] cv::Mat draw_pattern(const Pattern& pattern, const Rig& rig,
                                   const DrawOptions& options = {});

/// The same for a projector of which only the size is known.
/// \throws InvalidInput if the pattern is not valid or a size is not in [1, 65535].
[[nodiscard]] cv::Mat draw_pattern(const Pattern& pattern, int width, int height, int bits = 8);

/// A uniform picture. \param rgb in [0, 1]. \throws InvalidInput as above.
[[nodiscard]] cv::Mat draw_uniform(const Eigen::Vector3d& rgb, int width, int height, int bits = 8);

/// The pattern with one of its colours everywhere: what a colour is trained with.
/// \throws InvalidInput unless `color` is one of its colours.
[[nodiscard]] Pattern single_color(const Pattern& pattern, int color);
/// The pattern's sinusoid in white.
[[nodiscard]] Pattern without_stripes(const Pattern& pattern);

/// `steps` grey levels of 8 bit from 0 to 255 at equal distances, for a response curve.
/// \throws InvalidInput unless 2 <= steps <= 256.
[[nodiscard]] std::vector<int> grey_levels(int steps);

}  // namespace palpate::sensing
