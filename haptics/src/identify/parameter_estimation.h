// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "identify/parameter_search.h"
#include "palpate/haptics/identify.h"
#include "palpate/probing/acquisition.h"
#include "samples/realigned_pairs.h"

namespace palpate::haptics {

/// \throws InvalidInput if an option is outside its range, or one noise is given without the other.
void check_identify_options(IdentifyOptions options);

/// A direction of the parameters is undetermined if its standard error is at least this, in units
/// of their scales, so that a change of one scale is less than three standard errors.
inline constexpr double kUndetermined = 1.0 / 3;

struct LawEstimate {
  Eigen::VectorXd parameters;
  Identification report;
  Weights weights;          ///< of the pairs, at the end
  Predictions predictions;  ///< for the parameters
};

/// Weighted least squares over all pairs (described in identify.h).
[[nodiscard]] LawEstimate estimate(const ParametricLaw& law, std::span<const Pair> pairs,
                                   std::span<const probing::Contact> contacts,
                                   const IdentifyOptions& options);

}  // namespace palpate::haptics
