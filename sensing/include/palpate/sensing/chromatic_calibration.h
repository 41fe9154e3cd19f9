// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "palpate/geometry/range_map.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"

namespace palpate::sensing {

/// A surface under the white sinusoid of a pattern (thesis 3.4.2).
struct WhiteImage {
  std::string name;  ///< for messages
  cv::Mat image;     ///< 8 or 16 bit, linear, BGR, of the camera's size
  /// Depths [mm] of the surface, NaN where unknown, right to about a period of the sinusoid: they
  /// tell how many periods its phase lacks. Nothing: the surface is plane, and that number is found
  /// as the one with which its points lie in a plane.
  std::optional<geometry::ImageF> depth = {};
};

struct ChromaticCalibrationOptions {
  /// A pixel is lit iff the projector's light >= min_signal of full scale; in (0, 1).
  double min_signal = 0.02;
  /// Its phase counts iff in every channel amplitude >= min_modulation of full scale; in (0, 1) ...
  double min_modulation = 0.01;
  /// ... and amplitude / mean >= min_contrast times that of the pattern; in (0, 1).
  double min_contrast = 0.3;
  /// Alpha and beta are sought in 1 +- search_range, gamma within half a period; in (0, 0.2].
  double search_range = 0.02;
};

/// What was found of one channel.
struct ChannelCalibration {
  ChromaticShift shift;      ///< relative to green
  ChromaticShift deviation;  ///< standard deviations of alpha, beta and gamma
  double rms_before = 0;     ///< [rad] phase relative to green, as it is
  double rms_after = 0;      ///< [rad] and compensated
  int cells = 0;             ///< independent phase measurements that were used
  int outliers = 0;          ///< and those that were not, for their residuals
  /// How well the measurements tell the parameters apart: the smallest singular value of the
  /// Jacobian whose columns are scaled to length one; 1 is ideal, 0 undetermined.
  double separation = 0;
};

/// What became of one image.
struct WhiteImageUse {
  std::string name;
  int cells = 0;            ///< phase measurements that are reliable
  double median_depth = 0;  ///< [mm] of these; NaN if there are none
  /// Standard deviation of the number of periods that was found from a plane surface, slow errors
  /// counted in; above about 1/2 it is a guess that holds only if the rig is exact. 0 if depths
  /// were given.
  double period_deviation = 0;
  std::string problem;  ///< why there are none; empty if there are
};

struct ChromaticCalibration {
  ChannelCalibration red;
  ChannelCalibration blue;
  std::vector<WhiteImageUse> images;
};

/// Below this `separation` the deviations are large, and errors of the rig or the camera pass for
/// chromatic values: more distances, or tilted surfaces, are called for.
inline constexpr double kPoorSeparation = 0.05;

/// Finds alpha, beta and gamma of red and blue from images of surfaces at several distances under
/// the white sinusoid: minimises the sum over reliable pixels of the squared phase difference to
/// green after compensation (Eq. 3.15), by robust Gauss-Newton steps. The compensated phase is that
/// of the erratum to Eq. 3.16, in its form for any pose of the projector and either axis (the
/// decoder's own model): a channel shows at the camera direction y / alpha what green shows at y,
/// and its phase lags by 2 pi / period * (p - p') where p is green's projector pixel and p' the one
/// that beta and gamma send to the same place. Pixels are reliable if their whole demodulation
/// window is lit and not saturated; what does not fit is left out (Tukey's weights). The deviations
/// come from the residuals and the Jacobian, residuals that hang together (64 px) counted as such.
/// \param rig its chromatic values are not used.
/// \param pattern its axis, period and phase are used; its stripes are not.
/// \throws InvalidInput if an argument is not valid, an image has another size or not three
/// channels; SolverError if too few pixels are reliable or they do not determine the parameters.
[[nodiscard]] ChromaticCalibration calibrate_chromatic(
    const std::vector<WhiteImage>& images, const Rig& rig, const Pattern& pattern,
    const ChromaticCalibrationOptions& options = {});

}  // namespace palpate::sensing
