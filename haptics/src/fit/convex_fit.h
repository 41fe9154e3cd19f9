// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "fit/whitened_problem.h"
#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

struct ConvexFit {
  ForceField field;
  double condition = 1;
  int iterations = 0;
};

/// Fits isotropic and ridge bases with weights >= 0 to displacements and forces, 3 x N each, in
/// units of their extent: more than are needed at first (`convex_start`), which then are refined
/// together, and removed down to `max_bases` >= 1, or as many as the samples determine, and on for
/// as long as noise explains the errors (chi^2 is below its mean by half a deviation), or their
/// root mean square is at most `accuracy`, or it pays by Akaike's information criterion.
[[nodiscard]] ConvexFit fit_convex(const Eigen::Matrix3Xd& displacements,
                                   const Eigen::Matrix3Xd& forces, const SampleNoise& noise,
                                   double accuracy, int max_bases);

}  // namespace palpate::haptics
