// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/haptics/force_field.h"
#include "whitened_problem.h"

namespace palpate::haptics {

struct ConvexSolution {
  double loss = 0;  ///< of the field that was reached
  int iterations = 0;
  bool converged = false;
};

/// Moves all bases of a field to where the loss is least, with weights >= 0: Levenberg-Marquardt
/// with a Gauss-Newton matrix of the robust loss, steps cut at the bounds. A ridge beyond all
/// samples is rounded so far that it makes no wall there. Turning the frame turns the steps: what
/// belongs to one vector is damped alike.
[[nodiscard]] ConvexSolution refine(const WhitenedProblem& problem, int max_iterations,
                                    ForceField& field);

/// Removes the base that the others can replace best, to second order of the loss, and moves them
/// so.
void remove_least(const WhitenedProblem& problem, ForceField& field);

/// Condition number of the fit: of the Jacobian with columns of unit length.
[[nodiscard]] double condition_number(const WhitenedProblem& problem, const ForceField& field);

}  // namespace palpate::haptics
