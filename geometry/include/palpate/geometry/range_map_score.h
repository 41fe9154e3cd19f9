// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "palpate/geometry/range_map.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Statistics of a set of errors. If the set is empty, the count is 0 and all others are NaN.
struct ErrorStatistics {
  long count = 0;
  double rms = 0;     ///< square root of the mean square
  double median = 0;  ///< of the absolute values
  double p90 = 0;     ///< 90 % quantile of the absolute values
  double p95 = 0;     ///< 95 % quantile of the absolute values
  double max = 0;     ///< of the absolute values
};

/// Statistics of the finite values among `errors`, in their unit.
[[nodiscard]] ErrorStatistics error_statistics(std::vector<double> errors);

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

/// Signed distance [mm] of each point (3 x N) from a surface: positive on the side of the surface's
/// normals, also where an edge or a vertex is nearest. NaN for a point that is not finite.
/// \throws InvalidInput if `surface` is not a valid mesh.
[[nodiscard]] Eigen::VectorXd distances_to_surface(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                                   const TriangleMesh& surface);

/// Distance [mm] >= 0 of each point (3 x N) from a surface, for the part that both have in common.
/// NaN where the nearest point is on the surface's border, where the distance exceeds
/// `max_distance`, and for a point that is not finite.
/// \throws InvalidInput if `surface` is not a valid mesh, or unless max_distance > 0.
[[nodiscard]] Eigen::VectorXd distances_in_both(
    const Eigen::Ref<const Eigen::Matrix3Xd>& points, const TriangleMesh& surface,
    double max_distance = std::numeric_limits<double>::infinity());

}  // namespace palpate::geometry
