// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/haptics/force_field.h"
#include "whitened_problem.h"

namespace palpate::haptics {

struct ConvexFit {
  ForceField field;
  double chi2 = 0;        ///< per degree of freedom, without outliers if they are few
  int outliers = 0;       ///< samples whose error noise does not make
  double mean_noise = 0;  ///< mean squared error that the noise makes
  double condition = 1;
  int iterations = 0;
};

/// Fits isotropic and ridge bases with weights >= 0 to displacements and forces, 3 x N each, in
/// units of their extent: more than are needed at first (`convex_start`), which then are refined
/// together, and removed as long as the root mean squared error is at most `accuracy`, or noise
/// explains the errors, or it pays by the Bayesian information criterion.
[[nodiscard]] ConvexFit fit_convex(const Eigen::Matrix3Xd& displacements,
                                   const Eigen::Matrix3Xd& forces, const SampleNoise& noise,
                                   double accuracy, int max_bases);

}  // namespace palpate::haptics
