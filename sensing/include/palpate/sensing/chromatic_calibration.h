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

/// An image of a surface under the pattern's white sinusoid (thesis 3.4.2).
struct WhiteImage {
  std::string name;  ///< used in messages
  cv::Mat image;     ///< 8 or 16 bit, linear, BGR, of the camera's size
  /// Depth [mm] of the surface, NaN where unknown, accurate to about one period of the sinusoid;
  /// it resolves the number of periods that the wrapped phase lacks. If empty, the surface is
  /// assumed to be a plane, and the number is the one that makes its points coplanar.
  std::optional<geometry::ImageF> depth = {};
};

struct ChromaticCalibrationOptions {
  /// A pixel is lit if the projector's light >= min_signal of full scale; in (0, 1).
  double min_signal = 0.02;
  /// Its phase is used if in every channel the amplitude >= min_modulation of full scale, in
  /// (0, 1), ...
  double min_modulation = 0.01;
  /// ... and amplitude / mean >= min_contrast times that of the pattern; in (0, 1).
  double min_contrast = 0.3;
  /// Alpha and beta are searched within 1 +- search_range, gamma within half a period; in (0, 0.2].
  double search_range = 0.02;
};

/// Calibration result of one channel.
struct ChannelCalibration {
  ChromaticShift shift;      ///< relative to green
  ChromaticShift deviation;  ///< standard deviations of alpha, beta and gamma
  double rms_before = 0;     ///< [rad] RMS phase difference to green without compensation
  double rms_after = 0;      ///< [rad] the same with compensation
  int cells = 0;             ///< independent phase measurements used
  int outliers = 0;          ///< phase measurements rejected because of large residuals
  /// Separation of the parameters by the measurements: smallest singular value of the Jacobian
  /// after its columns are scaled to unit length. 1 is ideal, 0 means undetermined.
  double separation = 0;
};

/// The use of one image.
struct WhiteImageUse {
  std::string name;
  int cells = 0;                         ///< reliable phase measurements
  std::optional<double> median_depth{};  ///< [mm] of these measurements, if there are any
  /// Standard deviation of the number of periods found from a plane surface, including slowly
  /// varying errors and, if its covariance is known, those of the rig. Above 1/4, or above 1/10
  /// without the covariance, the image is not used. Not set if the depths were given.
  std::optional<double> period_deviation{};
  std::string problem;  ///< why the image has no measurements; empty if it has some
};

struct ChromaticCalibration {
  ChannelCalibration red;
  ChannelCalibration blue;
  std::vector<WhiteImageUse> images;
};

/// If `separation` is smaller than this, the deviations are large and errors of the rig or the
/// camera can be mistaken for chromatic shifts. Add images at more distances, or of tilted
/// surfaces.
inline constexpr double kPoorSeparation = 0.05;

/// Estimates alpha, beta and gamma of red and blue from images of surfaces at several distances
/// under the white sinusoid. Minimises the squared phase difference to green after compensation
/// (Eq. 3.15) over the reliable pixels by Gauss-Newton with Tukey's weights.
///
/// The model is the decoder's: the erratum to Eq. 3.16, generalised to any projector pose and
/// either axis. A channel shows at the camera direction y / alpha what green shows at y, and its
/// phase lags by 2 pi / period * (p - p'), where p is green's projector pixel and p' is the pixel
/// that beta and gamma send to the same place. A pixel is reliable if its whole demodulation window
/// is lit and not saturated. The deviations follow from the residuals and the Jacobian, with
/// residuals taken as correlated within blocks of 64 px.
/// \param rig      its chromatic values are not used.
/// \param pattern  its axis, period and phase are used; its stripes are not.
/// \throws InvalidInput if an argument is not valid, or an image has the wrong size or does not
/// have three channels.
/// \throws SolverError if too few pixels are reliable or they do not determine the parameters.
[[nodiscard]] ChromaticCalibration calibrate_chromatic(
    const std::vector<WhiteImage>& images, const Rig& rig, const Pattern& pattern,
    const ChromaticCalibrationOptions& options = {});

}  // namespace palpate::sensing
