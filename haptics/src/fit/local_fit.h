// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fit/field_objective.h"
#include "fit/field_solver.h"
#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/passivity_certificate.h"

namespace palpate::haptics {

/// The smallest eigenvalue of the stiffness at zero displacement.
[[nodiscard]] double smallest_stiffness(const ForceField& field);

struct LocalFitOptions {
  double accuracy = 0;  ///< bases are added until rms <= accuracy; >= 0
  int max_bases = 6;    ///< >= 1
  double epsilon = 1;   ///< > 0, epsilon of each base, or its start value
  FieldConstraints constraints;
};

struct LocalFit {
  ForceField field;
  double rms = 0;  ///< sqrt(mean |error|^2)
  int iterations = 0;
  FitStop stop = FitStop::not_converged;
};

/// Fits isotropic bases whose energy has a local minimum at zero (thesis 5.3.1), in units of the
/// data. Bases are added one by one. Each starts at the displacement, or its multiple by -1, 2 or
/// -2, that reduces the linear least squares most. Then all bases are optimised (Ipopt).
[[nodiscard]] LocalFit fit_local(const FieldObjective& objective, const LocalFitOptions& options);

struct CertifiedFit {
  LocalFit fit;
  PassivityCertificate certificate;  ///< of the field in `fit`: read this before you use it
  int repairs = 0;                   ///< refits with one more place where energy must not be lost
};

/// A local fit that is passive over the reachable volume, in units of the data. A place where the
/// certificate finds too little energy becomes a constraint, and all bases are optimised again, a
/// limited number of times. If that fails, the result has the last field, and its certificate says
/// so.
[[nodiscard]] CertifiedFit fit_certified(const FieldObjective& objective,
                                         const LocalFitOptions& options,
                                         const ReachableVolume& volume);

}  // namespace palpate::haptics
