// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/eigen_alignment.h"

/// Points of a cloud (3 x N [mm]) that are not outliers. Points with a coordinate that is not
/// finite are left out and are not neighbours of others. Results do not depend on the order of the
/// points (for statistics: up to rounding), the frame, or the number of threads.
namespace palpate::geometry {

/// The meaning, unit and range of each field stand in its list, `visit`.
struct OutlierOptions {
  int neighbours = 16;
  double max_deviations = 3;
  /// Called in the calling thread after each part of the points; the last call has done == total.
  /// If it throws, the work ends.
  std::function<void(int done, int total)> progress = {};
};

void visit(OutlierOptions& options, FieldVisitor& visitor);

/// Leaves out points that are unusually far from their neighbours (Rusu et al. 2008).
/// \return indices of the kept points, ascending; all known ones if there are fewer than 3.
/// \throws InvalidInput if an option is outside its range.
[[nodiscard]] std::vector<int> without_outliers(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                                const OutlierOptions& options = {});

/// Leaves out points with fewer than `neighbours` other points within the distance `radius` [mm].
/// \param progress as in `OutlierOptions`.
/// \return indices of the kept points, ascending.
/// \throws InvalidInput unless radius > 0 and `neighbours` is in [1, kMostNeighbours].
[[nodiscard]] std::vector<int> without_isolated(
    const Eigen::Ref<const Eigen::Matrix3Xd>& points, double radius, int neighbours,
    const std::function<void(int done, int total)>& progress = {});

}  // namespace palpate::geometry
