// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct RegistrationOptions {
  int max_iterations = 100;  ///< >= 1
  /// Points further from the surface than this fraction of the target's diagonal are left out of a
  /// step; > 0.
  double max_correspondence = 0.1;
};

enum class RegistrationStop {
  converged,       ///< a step moved the points by no more than the rounding of PCL's floats
  max_iterations,  ///< not settled yet
  too_few_pairs  ///< fewer than three points within `max_correspondence`: start nearer, or raise it
};

struct Registration {
  /// Maps source points to the target's frame.
  Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
  /// [mm] root mean square of the distances from the moved points of `pairs` to the surface; NaN
  /// without pairs.
  double rms = 0;
  int pairs = 0;  ///< moved points within `max_correspondence` of the surface
  /// Read this before you use the pose.
  RegistrationStop stop = RegistrationStop::max_iterations;
};

/// Moves points rigidly onto a mesh by iterated closest points (Besl and McKay 1992): each point is
/// paired with the nearest point of the surface itself, in double; PCL estimates the step, to these
/// points while far and to their planes (Chen and Medioni 1992) when near. Where the planes do not
/// fix the pose (a plate, a sphere) the points are not moved along the surface without need. Finds
/// the nearest minimum: from 25 degrees and a fifth of the size away usually the right one.
///
/// `points` is 3 x N [mm]; points that are not finite are left out.
/// \throws InvalidInput on a bad mesh, fewer than three finite points, or an option out of range.
[[nodiscard]] Registration register_points(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                           const TriangleMesh& target,
                                           const RegistrationOptions& options = {});

}  // namespace palpate::geometry
