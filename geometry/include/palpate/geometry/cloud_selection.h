// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "palpate/geometry/mesh_io.h"

/// Makes clouds, with their attributes, from parts of others.
namespace palpate::geometry {

/// Indices of the points (3 x N [mm]) within a box, ends included, ascending; a point with a
/// coordinate that is not finite is in no box.
[[nodiscard]] std::vector<int> points_in_box(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                             const Eigen::AlignedBox3d& box);

/// The points at `indices`, in that order, with their attributes; not organised. Comments and unit
/// stay.
/// \throws InvalidInput if an index is not one of a point, or the cloud's size or an attribute is
/// not valid.
[[nodiscard]] PointCloud selected(const PointCloud& cloud, std::span<const int> indices);

/// The same cloud, as organised as before, with NaN in place of the points that are not at
/// `indices`. Attributes stay.
/// \throws InvalidInput as `selected`.
[[nodiscard]] PointCloud with_only(const PointCloud& cloud, std::span<const int> indices);

/// One point for each group of points: `points` (3 x G), each with the means of its
/// group's attributes as far as they are known, rounded if they are integers; means
/// of normals get unit length. Not organised; lists are dropped. Comments and unit
/// stay.
/// \param group N: the group of each point, -1 for none, as in `VoxelSample::voxel`.
/// \throws InvalidInput unless each point has a group in [-1, G) and no group is empty, or as
/// `selected`.
[[nodiscard]] PointCloud averaged(const PointCloud& cloud, std::span<const int> group,
                                  const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// All points of several clouds, one cloud after the other, with those attributes that all have
/// with the same type and without lists; not organised unless it is one cloud. Comments and unit
/// are the first cloud's.
/// \throws InvalidInput if there is no cloud.
[[nodiscard]] PointCloud joined(std::span<const PointCloud> clouds);

}  // namespace palpate::geometry
