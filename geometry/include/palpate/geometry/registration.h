// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct RegistrationOptions {
  int max_iterations = 100;         ///< >= 1
  double max_correspondence = 0.1;  ///< pairs further apart than this fraction of the target's diagonal are left out; > 0
};

enum class RegistrationStop { converged, max_iterations, too_few_pairs };

struct Registration {
  Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
  double rms = 0;        ///< [mm] of the distances from the moved source points to the target's surface
  int pairs = 0;         ///< points within `max_correspondence` of the surface
  RegistrationStop stop = RegistrationStop::max_iterations;  ///< read this before you use the pose
};

/// Moves points rigidly onto a mesh by iterated closest points (PCL, point to plane).
/// `points` is 3 x N [mm]; NaN points are left out.
/// \throws InvalidInput on a bad mesh, fewer than three finite points, or an option out of range.
[[nodiscard]] Registration register_points(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                           const TriangleMesh& target, const RegistrationOptions& options = {});

}  // namespace palpate::geometry
