// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "fit/whitened_problem.h"

namespace palpate::haptics {

/// Number of parts of the pairs that are left out one after another.
inline constexpr Eigen::Index kLeftOutParts = 5;

struct LeftOutOptions {
  SampleNoise noise;    ///< that convex fits assume
  double accuracy = 0;  ///< as `fit_convex`
  int max_bases = 1;    ///< as `fit_convex`
};

/// N squared lengths of errors, whitened as in `problem`: each pair is predicted by a convex fit to
/// the pairs of the other parts. Part k has every kLeftOutParts-th pair from the k-th on, so
/// `problem` needs at least kLeftOutParts pairs.
[[nodiscard]] Eigen::VectorXd left_out_squares(const WhitenedProblem& problem,
                                               const LeftOutOptions& options);

/// The variance of a component that the median of squared lengths of errors has if it is noise.
[[nodiscard]] double typical_variance(const Eigen::VectorXd& squares);

/// Mean of squared lengths, none of which counts with more than `most`.
[[nodiscard]] double capped_mean(const Eigen::VectorXd& squares, double most);

/// Expected ratio of the mean squared errors at other pairs to those at fitted pairs (generalised
/// cross-validation), if `parameters` of `numbers` were fitted: 1 / (1 - parameters / numbers)^2;
/// infinity if all were.
[[nodiscard]] double expected_growth(double parameters, double numbers);

}  // namespace palpate::haptics
