// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/haptics/force_field.h"
#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/realignment.h"

namespace palpate::haptics {

/// Prior of a compliance: `mean` [mm/N], symmetric, with the standard deviation `deviation` [mm/N]
/// > 0 of each entry.
struct CompliancePrior {
  Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
  double deviation = 0;
};

/// l(f) + G f: `local` has force and displacement exchanged, see `LocalPart`.
struct Series {
  const ForceField& local;
  Eigen::Matrix3d global = Eigen::Matrix3d::Zero();

  [[nodiscard]] Eigen::Vector3d displacement(const Eigen::Vector3d& f) const {
    return force(local, f) + global * f;
  }
  [[nodiscard]] Eigen::Matrix3d compliance(const Eigen::Vector3d& f) const {
    return stiffness(local, f) + global;
  }
};

/// [mm] and [N], both > 0: at least the rounding errors of the samples.
struct PairNoise {
  double displacement = 0, force = 0;
};
[[nodiscard]] PairNoise pair_noise(const ForceSamples& samples, const FitNoise& noise);

/// Fits G by robust least squares. Errors are in units of the noise of the displacements and,
/// through the compliance, of the forces; outliers hardly count. The result lies on the line from
/// the prior's mean to the least-squares solution, as far as the compliance stays positive
/// semi-definite at the samples' forces and at `forces`.
[[nodiscard]] Eigen::Matrix3d fit_global_compliance(const ForceSamples& samples,
                                                    const ForceField& local,
                                                    const CompliancePrior& prior,
                                                    const PairNoise& noise,
                                                    const Eigen::Matrix3Xd& forces);

/// Sum of the squared errors of displacements in units of their noise, per degree of freedom;
/// without outliers if they are few.
[[nodiscard]] double chi2(const Series& series, const ForceSamples& samples,
                          const PairNoise& noise);

/// Selects the columns of some samples.
[[nodiscard]] ForceSamples columns(const ForceSamples& samples,
                                   const std::vector<Eigen::Index>& which);

/// Selects `count` columns by farthest-point sampling, starting with the longest; all if there are
/// no more.
[[nodiscard]] Eigen::Matrix3Xd spread_columns(const Eigen::Matrix3Xd& all, Eigen::Index count);

}  // namespace palpate::haptics
