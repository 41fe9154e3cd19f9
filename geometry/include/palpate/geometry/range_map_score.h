// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/range_map.h"

namespace palpate::geometry {

/// Depth `measured` minus depth `reference` [mm], pixel by pixel; NaN where either is unknown.
/// \throws InvalidInput unless both have the same size.
[[nodiscard]] ImageF depth_difference(const ImageF& measured, const ImageF& reference);

/// Errors of a measured range map relative to a known truth.
struct RangeMapScore {
  ErrorStatistics error;  ///< [mm] depth errors where both are known
  double distance = 0;    ///< [mm] median true depth where both are known
  /// Fraction of the pixels of `measurable` that have a depth; NaN if there are none.
  double reconstructed = 0;
  /// Fraction of the pixels with a depth whose error exceeds `max_error` or where there is no
  /// object; NaN if there are none.
  double wrong = 0;
};

/// Scores a measured range map.
/// \param measurable  true where a sensor can measure: visible to the camera and lit.
/// \param max_error   [mm] a pixel with a larger error is wrong; > 0.
/// \throws InvalidInput unless all have the same size and max_error > 0.
[[nodiscard]] RangeMapScore score_range_map(
    const ImageF& measured, const ImageF& truth,
    const Eigen::Ref<const Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>&
        measurable,
    double max_error);

}  // namespace palpate::geometry
