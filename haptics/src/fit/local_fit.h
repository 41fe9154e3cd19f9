// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fit/field_objective.h"
#include "fit/field_solver.h"
#include "palpate/haptics/force_field_fit.h"

namespace palpate::haptics {

struct LocalFitOptions {
  double accuracy = 0;  ///< bases are added until rms <= accuracy; >= 0
  int max_bases = 6;    ///< >= 1
  double epsilon = 1;   ///< > 0, of each base, or where it starts
  FieldConstraints constraints;
};

struct LocalFit {
  ForceField field;
  double rms = 0;  ///< sqrt(mean |error|^2)
  int iterations = 0;
  FitStop stop = FitStop::not_converged;
};

/// Fits isotropic bases whose energy has a local minimum at zero (thesis 5.3.1), in units of the
/// data. Bases are added one by one. Each starts where it alone lowers the linear least squares
/// most, among the displacements and their multiples by -1, 2 and -2; then all are moved (Ipopt).
[[nodiscard]] LocalFit fit_local(const FieldObjective& objective, const LocalFitOptions& options);

/// The field that moves from a start to where the error is least, with the constraints.
[[nodiscard]] LocalFit refit(const FieldObjective& objective, const ForceField& start,
                             const FieldConstraints& constraints);

}  // namespace palpate::haptics
