// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "phase/demodulation.h"

namespace palpate::sensing {

/// Adapts what a window of the carrier's frequency measured to the frequency that is really there.
///
/// A surface that slopes, or lies nearer or farther than the carrier was made for, shows the
/// sinusoid at carrier + delta. To first order in the window, z exp(i delta k), the fit then gives
///   G(delta) z + H(delta) conj(z) exp(-2 i carrier row):
/// its mirror image leaks in as a ripple of half the period, and a part epsilon(delta) of the
/// sinusoid's power stays in the residual. Both are taken out; the frequency is read from how the
/// phase changes over `reach` rows up and down, all channels together.
class LocalFrequency {
 public:
  explicit LocalFrequency(const DemodulationFilter& filter);

  /// px; half a period, so that the ripple itself does not enter the frequency.
  [[nodiscard]] int reach() const { return reach_; }
  /// Adapts one row, where the mask holds the pixels `reach` rows above and below, too. To be
  /// called for row after row; the rows below must not have been adapted.
  void adapt(long row, Demodulation& signal);

  /// Degrees of the polynomials in delta that stand for H / G and epsilon.
  static constexpr int kDegree = 8;
  /// Frequencies off by more than this part of the carrier are treated as off by so much.
  static constexpr double kLargestDeviation = 0.25;

  using Polynomial = Eigen::Array<float, kDegree + 1, 1>;

 private:
  int reach_;
  double carrier_;
  Polynomial ripple_;  ///< H / G
  Polynomial power_;   ///< residual over the sum of re^2 + im^2 that was measured
  Eigen::ArrayXf product_re_;
  Eigen::ArrayXf product_im_;
  Eigen::ArrayXf squares_;
};

}  // namespace palpate::sensing
