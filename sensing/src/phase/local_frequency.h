// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "phase/demodulation.h"

namespace palpate::sensing {

/// Corrects a demodulation at the carrier frequency for the actual local frequency.
///
/// A surface that slopes, or whose depth differs from the carrier's, shows the sinusoid at the
/// frequency carrier + delta. For z exp(i delta k), to first order in the window, the fit gives
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
  int reach_;
  double carrier_;
  Polynomial ripple_;  ///< H / G
  Polynomial power_;   ///< residual divided by the measured sum of re^2 + im^2
  Eigen::ArrayXf product_re_;
  Eigen::ArrayXf product_im_;
  Eigen::ArrayXf squares_;
};

}  // namespace palpate::sensing
