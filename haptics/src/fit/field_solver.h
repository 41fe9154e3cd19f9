// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fit/field_objective.h"

namespace palpate::haptics {

/// Constraints on a field, in units of the data.
struct FieldConstraints {
  /// Smallest eigenvalue of the stiffness at zero, > 0: larger than the solver's constraint
  /// tolerance, so that the result is positive semi-definite in floating point too.
  double least_stiffness = 1e-5;
  bool free_epsilon = false;  ///< if false, each base keeps its initial epsilon
  /// Places x, not zero, at which the energy must be >= least_secant / 2 |x|^2.
  std::vector<Eigen::Vector3d> places;
  double least_secant = 0;
};

struct FieldSolution {
  Eigen::VectorXd parameters;  ///< as in FieldObjective
  double value = 0;            ///< of the objective
  int iterations = 0;
  bool converged = false;
};

/// Minimises the objective from a start, subject to the constraints and to bounds of the parameters
/// (Ipopt, exact second derivatives). If Ipopt gives up, its last result is returned as not
/// `converged`.
[[nodiscard]] FieldSolution solve_field(const FieldObjective& objective,
                                        const Eigen::Ref<const Eigen::VectorXd>& start,
                                        const FieldConstraints& constraints = {});

}  // namespace palpate::haptics
