// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fit/whitened_problem.h"
#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

struct ConvexFit {
  ForceField field;
  double condition = 1;
  int iterations = 0;
};

/// Fits isotropic and ridge bases with weights >= 0 to samples in units of their extent. `problem`
/// has to be whitened without a field.
///
/// The fit begins with more bases than are needed (`convex_start`) and refines them together. Bases
/// are then removed down to `max_bases` >= 1, or as many as the samples determine, and further for
/// as long as noise explains the errors (chi^2 is below its mean by half a deviation), the root
/// mean square of the errors is at most `accuracy`, or Akaike's information criterion gains.
[[nodiscard]] ConvexFit fit_convex(WhitenedProblem problem, double accuracy, int max_bases);

}  // namespace palpate::haptics
