// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fit/whitened_problem.h"
#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

/// A field of at most `max_bases` isotropic and ridge multiquadrics with weights > 0 that fits the
/// samples about as well as such fields do: a place to refine from.
///
/// Candidates of all kinds are taken from the samples: ridges along directions of displacements and
/// forces, and of their moments, at quantiles of the displacements along them; isotropic bases at
/// multiples of displacements; each with some epsilons. One by one, the candidate that lowers the
/// squared error fastest joins, and the weights of all solve the non-negative least squares (the
/// active-set method of Lawson and Hanson 1974, ch. 23), which may remove others. Then bases that
/// the others can replace are removed. The problem has to be whitened without a field.
[[nodiscard]] ForceField convex_start(const WhitenedProblem& problem, int max_bases);

}  // namespace palpate::haptics
