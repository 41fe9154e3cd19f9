// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fit/whitened_problem.h"
#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

/// Finds a start for the refinement: a field of at most `max_bases` isotropic and ridge
/// multiquadrics with weights > 0 that fits the samples about as well as such fields can. The
/// problem has to be whitened without a field.
///
/// Candidates come from the samples, each with several epsilons: ridges along directions of
/// displacements and forces, and of their moments, at quantiles of the displacements along them;
/// isotropic bases at multiples of displacements. In each step the candidate that reduces the
/// squared error fastest is added, and the weights of all are the non-negative least squares (the
/// active-set method of Lawson and Hanson 1974, ch. 23), which may remove others. Finally, bases
/// that the others can replace are removed.
[[nodiscard]] ForceField convex_start(const WhitenedProblem& problem, int max_bases);

}  // namespace palpate::haptics
