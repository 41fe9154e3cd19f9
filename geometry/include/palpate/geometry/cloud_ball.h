// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::geometry {

/// A ball of known radius in a view of a scene.
struct SeenBall {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< [mm]
  /// Relative precision of the coordinates of the centre: the mean of n n^T over the points on the
  /// ball with their weights, where n points from the centre to the point. Its trace is 1. The
  /// covariance of the centre is its inverse times a variance.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  int points = 0;  ///< on the ball
  double rms = 0;  ///< [mm] of their distances from the sphere
  /// [mm] Radius of the sphere that fits the points best; tells whether the given one is right.
  double radius = 0;
};

/// Finds the ball of a known radius that is partly visible in a cloud of points, among other
/// objects. Each point votes for the position one radius below it along its normal: the votes of
/// points on the ball agree. From the positions with most votes, a sphere of this radius is fitted
/// to the points whose normals agree with it, by least squares of their distances from it; outliers
/// are weighted down (Tukey). The sphere with most points on it is returned.
///
/// \param points 3 x N [mm]; those with a coordinate or normal that is not finite are left out.
/// \param normals 3 x N, unit, towards the camera, which is at the origin. They need not be exact.
/// \return none if fewer than 30 points are on the ball, these do not determine its centre, their
/// distances from it are larger than a twentieth of the radius (RMS), a fit with free radius fails,
/// or the camera sees more of other objects than of the ball in its middle.
/// \throws InvalidInput unless radius > 0 and there are as many normals as points.
[[nodiscard]] std::optional<SeenBall> find_ball(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                                const Eigen::Ref<const Eigen::Matrix3Xd>& normals,
                                                double radius);

}  // namespace palpate::geometry
