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

struct CertifiedFit {
  LocalFit fit;
  PassivityCertificate certificate;  ///< of the field in `fit`: read this before you use it
  int repairs = 0;                   ///< refits with one more place where energy must not be lost
};

/// A local fit that is passive over the reachable volume, in units of the data. Where the
/// certificate finds a place with too little energy, that place becomes a constraint and all bases
/// move again, up to a number of times. If the field is not passive then, the certificate says so
/// and the field is the last one.
[[nodiscard]] CertifiedFit fit_certified(const FieldObjective& objective,
                                         const LocalFitOptions& options,
                                         const ReachableVolume& volume);

}  // namespace palpate::haptics
