// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"

namespace palpate::sensing {

/// Options for drawing a pattern on the projector's panel.
/// The meaning, unit and range of each field stand in its list, `visit`.
struct DrawOptions {
  /// false: the pattern is drawn straight. A decoder that knows the projector's pose and lens sees
  /// what the rig predicts: a stripe edge or a phase is one coordinate of the panel. true: Eqs. 3.2
  /// and 3.11 hold (thesis 3.2.2), and on surfaces facing the camera the sinusoid has one period
  /// all over the image.
  bool rectify = false;
  bool compensate = true;  ///< by Eq. 3.13; in the list: compensation
  int bits = 8;
};

void visit(DrawOptions& options, FieldVisitor& visitor);

/// Returns the rig with which frames of a drawing have to be decoded.
///
/// `rectify` replaces the projector by a parallel one at the same place, with the same focal
/// lengths, whose panel holds everything that the real one shows. `compensate` sets beta = 1 and
/// gamma = 0, since the drawing compensates them; alpha belongs to the camera and stays. With
/// `rectify` alone the chromatic values are approximate, because they refer to the real panel, and
/// with `rectify` there is no covariance, for the same reason.
/// \throws InvalidInput if the rig is not valid or, for `rectify`, if the projector's lens model
/// cannot be inverted on its panel or light leaves it at more than 60 degrees to the camera's axis.
[[nodiscard]] Rig rig_of_drawing(const Rig& rig, const DrawOptions& options = {});

/// Draws the picture for the projector's panel: linear in the light, BGR, of the projector's size.
/// The sinusoid is sampled at pixel centres; a pixel crossed by a stripe edge mixes the two colours
/// in proportion to their areas.
/// \param pattern in pixels of `rig_of_drawing(rig, options).projector`.
/// \throws InvalidInput if pattern, rig or options are not valid.
[[nodiscard]] cv::Mat draw_pattern(const Pattern& pattern, const Rig& rig,
                                   const DrawOptions& options = {});

/// The same for a projector of which only the size is known.
/// \throws InvalidInput if the pattern is not valid or a size is not in [1, 65535].
[[nodiscard]] cv::Mat draw_pattern(const Pattern& pattern, int width, int height, int bits = 8);

/// Draws the images of a still scene (`Multishot`) in their order, as `draw_pattern` does: first
/// the sinusoids, then the bits of the code.
/// \throws InvalidInput also if the pattern is for one image.
[[nodiscard]] std::vector<cv::Mat> draw_multishot(const Pattern& pattern, const Rig& rig,
                                                  const DrawOptions& options = {});
[[nodiscard]] std::vector<cv::Mat> draw_multishot(const Pattern& pattern, int width, int height,
                                                  int bits = 8);

/// Draws a uniform picture.
/// \param rgb in [0, 1].
/// \throws InvalidInput as above.
[[nodiscard]] cv::Mat draw_uniform(const Eigen::Vector3d& rgb, int width, int height, int bits = 8);

/// The pattern with one of its colours everywhere, used for training this colour.
/// \throws InvalidInput unless `color` is an index of its colours.
[[nodiscard]] Pattern single_color(const Pattern& pattern, int color);
/// The pattern's sinusoid in white.
[[nodiscard]] Pattern without_stripes(const Pattern& pattern);

/// Makes `steps` equally spaced 8-bit grey levels from 0 to 255, for a response curve.
/// \throws InvalidInput unless 2 <= steps <= 256.
[[nodiscard]] std::vector<int> grey_levels(int steps);

}  // namespace palpate::sensing
