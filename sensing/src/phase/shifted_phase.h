// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "image/image_plane.h"

namespace palpate::sensing {

/// Least squares of values v_k = mean + B cos(phi + shift_k) + harmonics, the same for each pixel.
///
/// The fit has as many harmonics of the sinusoid as the number of images can separate from noise:
/// none below 7 images, the second below 10, the second and third otherwise. With equal steps they
/// do not change the phase; they only keep the effect of a response that is not linear, which then
/// does not disturb the phase, out of the remainder.
struct ShiftFit {
  Eigen::MatrixXf estimate;   ///< 3 x N: mean, B cos phi and B sin phi from the values
  Eigen::MatrixXf remainder;  ///< N x N: values minus fit
  /// Covariance of (B cos phi, B sin phi) if the values are independent with variance one.
  Eigen::Matrix2d spread;
  int freedom = 0;  ///< degrees of freedom of the remainder, >= 0

  [[nodiscard]] int images() const { return static_cast<int>(estimate.cols()); }
};
/// \param shifts [rad] that determine a sinusoid, as `check_pattern` ensures.
[[nodiscard]] ShiftFit make_shift_fit(const std::vector<double>& shifts);

/// Sums of one colour channel over the exposures in which none of the pixel's values is clipped, in
/// fractions of full scale.
struct ShiftedChannel {
  Plane mean;
  Plane re;     ///< B cos phi
  Plane im;     ///< B sin phi
  Plane count;  ///< number of these exposures
};

/// Light of a place and the variance of its values, of one channel.
struct VarianceSample {
  float light = 0;     ///< fraction of full scale
  float variance = 0;  ///< mean square of the remainder
};

/// Data of a still scene under shifted sinusoids, in the camera's orientation.
struct ShiftedImages {
  std::vector<ShiftedChannel> channels;  ///< green alone, or green, red, blue
  /// Mean square of the remainder of one value, summed over exposures and channels; 0 if `freedom`
  /// is 0.
  Plane remainder;
  Plane signal;  ///< largest B of all exposures and channels, clipped ones too
  std::vector<std::vector<VarianceSample>> samples;  ///< by channel
  /// True where the values of an exposure and a channel are clipped.
  std::vector<std::vector<Mask>> clipped;
  /// Sums of the products of the mean remainders, and of the amplitudes, of two pixels, one beside
  /// the other across the sinusoid, that are too far apart for common noise. Their ratio is the
  /// relative variance of residuals other than noise.
  double shared = 0;
  double power = 0;
};

/// Adds the images of one exposure.
/// \param images one per shift, of the same size and type; 8 or 16 bit, 1 or 3 channels.
/// \param least_amplitude B [fraction of full scale] from which on places count for noise.
/// \param varies_along_rows true if the sinusoid does
void add_exposure(std::span<const cv::Mat> images, const ShiftFit& fit, float least_amplitude,
                  bool varies_along_rows, ShiftedImages& sums);

/// Finds the pixels at which any of the images is at full scale in a channel (green; red; blue). In
/// colour images their neighbours count too, because demosaicing spreads clipped values.
[[nodiscard]] std::vector<Mask> clipped_places(std::span<const cv::Mat> images);

}  // namespace palpate::sensing
