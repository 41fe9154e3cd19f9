// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "palpate/geometry/range_map.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// What a set of errors amounts to. All NaN (and count 0) when there is none.
struct ErrorStatistics {
  long count = 0;
  double rms = 0;     ///< square root of the mean square
  double median = 0;  ///< of the absolute values, as are the next three
  double p90 = 0;
  double p95 = 0;
  double max = 0;
};

/// Statistics of the finite values among `errors`, in their unit.
[[nodiscard]] ErrorStatistics error_statistics(std::vector<double> errors);

/// Depth `measured` minus depth `reference` [mm], pixel by pixel; NaN where either is unknown.
/// \throws InvalidInput unless both have the same size.
[[nodiscard]] ImageF depth_difference(const ImageF& measured, const ImageF& reference);

/// How a measured range map stands against a known truth.
struct RangeMapScore {
  ErrorStatistics error;  ///< [mm] depth errors where both are known
  double distance = 0;    ///< [mm] median true depth there
  /// Fraction of the pixels of `measurable` that have a depth; NaN if there are none.
  double reconstructed = 0;
  /// Fraction of the pixels with a depth that are off by more than `max_error`, or lie where
  /// nothing is; NaN if there are none.
  double wrong = 0;
};

/// \param measurable  non-zero where a sensor can measure: visible to the camera and lit.
/// \param max_error   [mm] beyond it a pixel counts as wrong; > 0.
/// \throws InvalidInput unless all have the same size and max_error > 0.
[[nodiscard]] RangeMapScore score_range_map(
    const ImageF& measured, const ImageF& truth,
    const Eigen::Ref<const Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>&
        measurable,
    double max_error);

/// Signed distance [mm] of each point (3 x N) from a surface: positive on the side that the
/// surface's normals point to, also where an edge or a vertex is nearest. NaN for a point that is
/// not finite.
/// \throws InvalidInput if `surface` is not a valid mesh.
[[nodiscard]] Eigen::VectorXd distances_to_surface(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                                   const TriangleMesh& surface);

/// Distance [mm] >= 0 of each point (3 x N) from a surface, over the part of them that the surface
/// has too: NaN where the nearest point of the surface lies on its border, as it ends there, where
/// the distance is above `max_distance`, and for a point that is not finite.
/// \throws InvalidInput if `surface` is not a valid mesh, or unless max_distance > 0.
[[nodiscard]] Eigen::VectorXd distances_in_both(
    const Eigen::Ref<const Eigen::Matrix3Xd>& points, const TriangleMesh& surface,
    double max_distance = std::numeric_limits<double>::infinity());

}  // namespace palpate::geometry
