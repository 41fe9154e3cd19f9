// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "fit/whitened_problem.h"
#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

/// Stopping criteria of the minimisation of the loss.
struct Effort {
  int iterations = 0;  ///< upper limit
  /// A step that gains less than this ends the search; noise alone changes the loss by some units.
  double worthwhile = 0;
};

struct ConvexSolution {
  double loss = 0;  ///< of the errors of the resulting field
  int iterations = 0;
  bool converged = false;
};

/// Minimises the loss over all bases of a field, with weights >= 0 and epsilons close to the
/// expected ones unless the samples indicate otherwise (a prior of their logarithms, Student's t).
/// The method is Levenberg-Marquardt with a Gauss-Newton matrix of the robust loss and steps cut at
/// the bounds. The epsilon of a ridge beyond all samples is kept large enough to avoid a wall
/// there. The steps rotate with the frame, because the components of a vector have the same
/// damping.
ConvexSolution refine(const WhitenedProblem& problem, const Effort& effort, ForceField& field);

/// Fields with one base removed, for each of at most `count` bases that the others replace best, to
/// second order of the loss; best first. The other bases have been adjusted.
[[nodiscard]] std::vector<ForceField> without_one(const WhitenedProblem& problem,
                                                  const ForceField& field, std::size_t count);

/// Condition number of the fit: of the Jacobian with columns of unit length.
[[nodiscard]] double condition_number(const WhitenedProblem& problem, const ForceField& field);

}  // namespace palpate::haptics
