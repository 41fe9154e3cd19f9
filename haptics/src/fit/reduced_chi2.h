// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace palpate::haptics {

/// Squared length of a whitened error that makes an outlier: noise exceeds it once in 10^10
/// samples.
inline constexpr double kOutlier = 50;

struct ReducedChi2 {
  double value = 0;  ///< chi^2 per degree of freedom, about 1 where noise makes the errors
  int outliers = 0;
};

/// Of the squared lengths of whitened errors, three numbers each, after `parameters` were fitted.
/// Outliers are left out unless they are so many that they are what the fit cannot follow.
[[nodiscard]] ReducedChi2 reduced_chi2(const Eigen::VectorXd& squares, double parameters);

}  // namespace palpate::haptics
