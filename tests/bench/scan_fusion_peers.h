// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::bench {

/// The points that a camera measured, in the frame of the object [mm].
struct SeenPoints {
  Eigen::Matrix3Xd points;
  Eigen::Vector3d eye;
};

/// Fuses views as VDBFusion does (Vizzo et al. 2022), on OpenVDB's sparse grids of floats: along
/// the ray of each point, the voxels within `truncation` of it take the mean of their distances to
/// the points, with equal weights. The surface is where the mean is zero, between voxels that were
/// all measured.
[[nodiscard]] geometry::TriangleMesh fuse_with_openvdb(const std::vector<SeenPoints>& views,
                                                       double voxel, double truncation);

}  // namespace palpate::bench
