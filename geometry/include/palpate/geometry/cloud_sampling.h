// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

/// Reduces a cloud (3 x N [mm]) to fewer points that cover it evenly. Points with a coordinate that
/// is not finite are left out.
namespace palpate::geometry {

struct VoxelSample {
  Eigen::Matrix3Xd points;  ///< [mm] 3 x V: the mean of the points in each voxel
  std::vector<int> voxel;   ///< N: the voxel of each point, -1 if it is not known
};

/// Averages the points in each cube [i e, (i + 1) e) x [j e, (j + 1) e) x [k e, (k + 1) e), e being
/// `edge` [mm], so that the voxels of several clouds in one frame are the same. Voxels are in the
/// order of their first point; in another order of the points the means differ by rounding.
/// \throws InvalidInput unless edge > 0 and at least 2^-40 of each coordinate.
[[nodiscard]] VoxelSample voxel_sample(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                       double edge);

/// Chooses points such that no two are closer than `min_distance` [mm], and each point of the cloud
/// is closer than that to one of them (a maximal Poisson-disc sample). Points are taken in an order
/// given by a hash of their positions in the box around all of them, unless they are too close to
/// one taken before. The order of the points in the cloud does not matter, nor do the unit of
/// length and the position of the cloud, beyond the rounding of its coordinates; a rotated cloud
/// may have another sample. Equal points count as one, the first.
/// \param progress called after each part of the points; the last call has done == total. If it
/// throws, the work ends.
/// \return indices of the chosen points, ascending.
/// \throws InvalidInput unless min_distance > 0 and at least 2^-40 of the extent of the points.
[[nodiscard]] std::vector<int> poisson_sample(
    const Eigen::Ref<const Eigen::Matrix3Xd>& points, double min_distance,
    const std::function<void(int done, int total)>& progress = {});

}  // namespace palpate::geometry
