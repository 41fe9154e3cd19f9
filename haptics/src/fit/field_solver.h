// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fit/field_objective.h"

namespace palpate::haptics {

/// What a field has to keep, in units of the data.
struct FieldConstraints {
  /// Smallest eigenvalue of the stiffness at zero, > 0: above what the solver leaves of a
  /// constraint, so that the result is semi-definite in floating point too.
  double least_stiffness = 1e-5;
  bool free_epsilon = false;  ///< else each base keeps the epsilon it starts with
  /// Places x, not zero, where the energy is >= least_secant / 2 |x|^2.
  std::vector<Eigen::Vector3d> places;
  double least_secant = 0;
};

struct FieldSolution {
  Eigen::VectorXd parameters;  ///< as in FieldObjective
  double value = 0;            ///< of the objective
  int iterations = 0;
  bool converged = false;
};

/// Minimises the objective from a start, keeping the constraints and the parameters inside a box
/// (Ipopt, exact second derivatives). Where Ipopt gives up, what it had is not `converged`.
[[nodiscard]] FieldSolution solve_field(const FieldObjective& objective,
                                        const Eigen::Ref<const Eigen::VectorXd>& start,
                                        const FieldConstraints& constraints = {});

}  // namespace palpate::haptics
