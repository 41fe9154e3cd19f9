// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

struct FitOptions {
  double accuracy = 0.03;  ///< [N] bases are added until rms <= accuracy; >= 0
  int max_bases = 6;       ///< >= 1
  /// [mm] > 0; without one it is the root mean square of the displacements
  std::optional<double> epsilon = std::nullopt;
};

enum class FitStop {
  accurate,       ///< rms <= accuracy
  max_bases,      ///< `max_bases` are in use, or as many as the samples can determine
  no_gain,        ///< one more base did not pay by the Bayesian information criterion
  not_converged,  ///< the solver did not settle with one more base; the best field so far is
                  ///< returned
  not_determined  ///< forces without any displacement: the field is zero
};

struct FitResult {
  ForceField field;
  /// [N] sqrt(mean |force(displacement) - sample|^2), the length of the error vector
  double rms = 0;
  int iterations = 0;                     ///< of the solver, over all numbers of bases and starts
  FitStop stop = FitStop::not_converged;  ///< read this before you use the field
  /// [N/mm] smallest eigenvalue of the stiffness at zero displacement; >= 0
  double smallest_stiffness = 0;
};

/// Fits a radial basis field to pairs of displacement [mm] and force on the object [N], 3 x N each
/// (thesis 5.3.1, Eq 5.6): weights and centres are free, the stiffness at zero is kept positive
/// semi-definite (Eq 5.9), so that zero displacement is a local minimum of the energy.
///
/// Bases are added one by one. Each starts where it alone lowers the linear least squares most,
/// among the displacements and their multiples by -1, 2 and -2; then all are moved (Ipopt). The
/// result does not depend on the order of the samples, on units, or on threads.
/// \throws InvalidInput on no sample, sizes that differ, a sample that is not finite (naming its
/// index), or an option out of its range.
[[nodiscard]] FitResult fit_force_field(const Eigen::Ref<const Eigen::Matrix3Xd>& displacements,
                                        const Eigen::Ref<const Eigen::Matrix3Xd>& forces,
                                        const FitOptions& options = {});

/// In a word, for reports: "accurate", "max_bases", ...
[[nodiscard]] const char* to_string(FitStop stop);

}  // namespace palpate::haptics
