// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "phase/demodulation.h"

namespace palpate::sensing {

/// Corrects a demodulation at the carrier frequency for effects that the fit of a constant mean and
/// of a sinusoid leaves out: shading that changes evenly, and the actual local frequency.
///
/// *Shading.* If the light changes by s per row, s k leaks into the fit's quadrature as L s, a
/// ripple of one period in the phase (L is about period / (3 pi) for Hann's window of two periods).
/// s is the change of the fitted mean over `reach` rows up and down, in which the sinusoid itself
/// almost cancels. The residual keeps the part of the shading in it: next to a step of the
/// brightness, where s means little, the phase stays as uncertain as it is.
///
/// *Frequency.* A surface that slopes, or whose depth differs from the carrier's, shows the
/// sinusoid at the frequency carrier + delta. For z exp(i delta k), to first order in the window,
/// the fit and the correction of the shading give
///   G(delta) z + H(delta) conj(z) exp(-2 i carrier row):
/// the mirror image leaks in as a ripple of half the period, and a part epsilon(delta) of the
/// sinusoid's power remains in the residual. This class removes both. It measures the frequency
/// from the change of the phase over `reach` rows up and down, over all channels together.
class LocalFrequency {
 public:
  explicit LocalFrequency(const DemodulationFilter& filter);

  /// px; half a period, so that the ripple cancels in the frequency.
  [[nodiscard]] int reach() const { return reach_; }
  /// Corrects one row, at pixels whose neighbours `reach` rows above and below are in the mask.
  /// Call it for row after row; the rows below must not have been corrected yet.
  void adapt(long row, Demodulation& signal);

  /// Degree of the polynomials in delta that approximate H / G and epsilon.
  static constexpr int kDegree = 8;
  /// Frequency deviations are clamped to this fraction of the carrier.
  static constexpr double kLargestDeviation = 0.25;

  using Polynomial = Eigen::Array<float, kDegree + 1, 1>;

 private:
  void remove_shading(long row, Demodulation& signal);

  int reach_;
  double carrier_;
  int averages_;       ///< along the rows
  double leak_ = 0;    ///< [px] half of the quadrature from shading of slope one
  Polynomial ripple_;  ///< H / G
  Polynomial power_;   ///< residual divided by the measured sum of re^2 + im^2
  Eigen::ArrayXf product_re_;
  Eigen::ArrayXf product_im_;
  Eigen::ArrayXf squares_;
  Eigen::ArrayXf shading_;
  Eigen::ArrayXf smooth_shading_;
};

}  // namespace palpate::sensing
