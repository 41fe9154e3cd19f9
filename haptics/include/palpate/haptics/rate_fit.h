// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/haptics/force_field.h"
#include "palpate/haptics/rate_law.h"

namespace palpate::haptics {

/// The record of a contact over time, and its field, all in one frame.
struct RateRecord {
  ForceField field;  ///< of the force that stays, up to a factor that all contacts share
  ToolHistory path;
  Eigen::Matrix3Xd forces;  ///< [N] 3 x N, on the object, at the moments of the path
};

struct RateFitOptions {
  int most_terms = 2;  ///< 0 to 2
};

struct RateFit {
  std::vector<RateTerm> terms;   ///< the fastest first; empty: the records show none
  std::vector<RateTerm> errors;  ///< standard errors of the terms
  double scale = 1;              ///< of the fields, which makes them those of the force that stays
  double rms = 0;                ///< [N] root mean square of the lengths of the errors
  double rms_without = 0;        ///< [N] the same without a rate
  int samples = 0;
};

/// Fits how force depends on the rate, for all contacts together: the scale and the terms that
/// minimise the sum of squares of f - scale (F(u) + sum_i g_i F(u - z_i)). A term is added only if
/// it lowers the Bayesian information criterion (two parameters each, one datum a sample) and the
/// RMS by at least 2 %. Times of terms lie between the median step of the records and three times
/// the longest path. The result does not depend on the number of threads.
/// \throws InvalidInput if sizes differ, a number is not finite, times do not ascend on a path, or
/// there is no path of three samples.
[[nodiscard]] RateFit fit_rate(std::span<const RateRecord> records,
                               const RateFitOptions& options = {});

/// [N] Forces that the rate adds to those of a field along a path, 3 x N.
[[nodiscard]] Eigen::Matrix3Xd rate_forces(std::span<const RateTerm> terms, const ForceField& field,
                                           const ToolHistory& path);

}  // namespace palpate::haptics
