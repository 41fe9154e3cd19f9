// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <functional>

#include "palpate/geometry/eigen_alignment.h"

/// Distances between points. For distances from a surface see `distances_to_surface`
/// (mesh_distance.h).
///
/// In all functions on point clouds a point with a coordinate that is not finite is unknown: it is
/// no neighbour of any point, and its own results are NaN. Results are the same for any number of
/// threads. `progress` is called in the calling thread after each part of the points; the last call
/// has done == total. If it throws, the work ends.
namespace palpate::geometry {

/// Largest number of neighbours of a point that a function can use.
inline constexpr int kMostNeighbours = 1000;

/// Distance [mm] >= 0 of each point (3 x N) from the nearest point of `cloud` (3 x M); NaN for an
/// unknown point.
/// \throws InvalidInput if no point of the cloud is known, or a coordinate exceeds 1e100.
[[nodiscard]] Eigen::VectorXd distances_to_cloud(
    const Eigen::Ref<const Eigen::Matrix3Xd>& points,
    const Eigen::Ref<const Eigen::Matrix3Xd>& cloud,
    const std::function<void(int done, int total)>& progress = {});

/// Distance [mm] of each point (3 x N) from its `count`-th nearest other point; 0 if that many
/// others are at the same place, infinity if there are fewer others, and NaN for an unknown point.
/// \throws InvalidInput unless `count` is in [1, kMostNeighbours], or if a coordinate exceeds 1e100.
[[nodiscard]] Eigen::VectorXd neighbour_distances(
    const Eigen::Ref<const Eigen::Matrix3Xd>& points, int count = 1,
    const std::function<void(int done, int total)>& progress = {});

}  // namespace palpate::geometry
