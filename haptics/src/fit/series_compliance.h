// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/haptics/force_field.h"
#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/realignment.h"

namespace palpate::haptics {

/// What is expected of a compliance before samples are seen: `mean` [mm/N], symmetric, give or take
/// `deviation` [mm/N] > 0 in each of its entries.
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

/// [mm] and [N], both > 0: at least the rounding of the samples.
struct PairNoise {
  double displacement = 0, force = 0;
};
[[nodiscard]] PairNoise pair_noise(const ForceSamples& samples, const FitNoise& noise);

/// Robust least squares for G: errors in units of what the noise of displacements and, by the
/// compliance, of forces makes; those of outliers hardly count. As near to the least squares as
/// the compliance stays positive semi-definite at the samples' forces and at `forces`, on the way
/// there from the prior's mean.
[[nodiscard]] Eigen::Matrix3d fit_global_compliance(const ForceSamples& samples,
                                                    const ForceField& local,
                                                    const CompliancePrior& prior,
                                                    const PairNoise& noise,
                                                    const Eigen::Matrix3Xd& forces);

/// Sum of the squared errors of displacements, each in units of its noise, per degree of freedom;
/// without outliers if they are few.
[[nodiscard]] double chi2(const Series& series, const ForceSamples& samples,
                          const PairNoise& noise);

/// The columns of some samples.
[[nodiscard]] ForceSamples columns(const ForceSamples& samples,
                                   const std::vector<Eigen::Index>& which);

/// `count` of some columns, each time the one that is furthest from those before, from the longest
/// on; all if there are no more.
[[nodiscard]] Eigen::Matrix3Xd spread_columns(const Eigen::Matrix3Xd& all, Eigen::Index count);

}  // namespace palpate::haptics
