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
/// The fit starts with more bases than needed (`convex_start`) and refines them together. Bases are
/// then removed until at most `max_bases` >= 1, or as many as the samples determine, are left.
/// Removal continues while noise explains the errors (chi^2 is below its mean by half a standard
/// deviation), the root mean square error is at most `accuracy`, or Akaike's information criterion
/// improves.
[[nodiscard]] ConvexFit fit_convex(WhitenedProblem problem, double accuracy, int max_bases);

}  // namespace palpate::haptics
