// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "field_objective.h"

namespace palpate::haptics {

struct FieldSolution {
  Eigen::VectorXd parameters;  ///< as in FieldObjective
  double value = 0;            ///< of the objective
  int iterations = 0;
  bool converged = false;
};

/// Minimises the objective from a start, keeping the stiffness at zero positive semi-definite and
/// the parameters inside a box (Ipopt, exact second derivatives).
[[nodiscard]] FieldSolution solve_field(const FieldObjective& objective,
                                        const Eigen::Ref<const Eigen::VectorXd>& start);

}  // namespace palpate::haptics
