// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "fit/whitened_problem.h"
#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

/// How long to look for the least loss.
struct Effort {
  int iterations = 0;  ///< at most
  /// A step that gains less is the last; noise moves the loss by some units.
  double worthwhile = 0;
};

struct ConvexSolution {
  double loss = 0;  ///< of the errors of the field that was reached
  int iterations = 0;
  bool converged = false;
};

/// Moves all bases of a field to where the loss is least, with weights >= 0, and epsilons not far
/// from what is expected unless the samples tell otherwise (a prior of their logarithms, Student's
/// t): Levenberg-Marquardt with a Gauss-Newton matrix of the robust loss, steps cut at the bounds.
/// A ridge beyond all samples is rounded so far that it makes no wall there. Turning the frame
/// turns the steps: what belongs to one vector is damped alike.
ConvexSolution refine(const WhitenedProblem& problem, const Effort& effort, ForceField& field);

/// The field without one of its bases, for each of those that the others can replace best, to
/// second order of the loss, at most `count`: the best first. The others have moved accordingly.
[[nodiscard]] std::vector<ForceField> without_one(const WhitenedProblem& problem,
                                                  const ForceField& field, std::size_t count);

/// Condition number of the fit: of the Jacobian with columns of unit length.
[[nodiscard]] double condition_number(const WhitenedProblem& problem, const ForceField& field);

}  // namespace palpate::haptics
