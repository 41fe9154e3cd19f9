// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/eigen_alignment.h"

/// Planes, spheres and cylinders in a cloud of points (3 x N [mm]).
///
/// Random samples of a few points propose shapes (RANSAC; Fischler and Bolles 1981). The best of
/// these by the truncated squares of the distances (Torr and Zisserman 2000) is fitted to the
/// points within the tolerance by least squares of their distances from it, in double precision,
/// until they no longer change. The number of samples, at most 1e6, is such that a shape with the
/// share `min_share` of the points is missed with a probability of 1e-3.
///
/// Points with a coordinate that is not finite are left out. Results are the same for any number of
/// threads. The samples are the same for the same seed and order of the points; in another order or
/// frame the same shape is found, up to rounding, unless another one is about as large.
/// \throws InvalidInput if an option is outside its range, or max_radius is given for a plane.
namespace palpate::geometry {

/// The meaning, unit and range of each field stand in its list, `visit`.
struct CloudShapeOptions {
  std::optional<double> tolerance = {};  ///< must be given
  double min_share = 0.1;
  double max_radius = std::numeric_limits<double>::infinity();
  unsigned seed = 1;
  /// Called in the calling thread after each batch of trials, often fewer times than `total`; the
  /// last call has done == total, and a cloud with too few points has none. If it throws, the
  /// search ends.
  std::function<void(int done, int total)> progress = {};
};

void visit(CloudShapeOptions& options, FieldVisitor& visitor);

struct PointsOnShape {
  std::vector<int> inliers;  ///< indices of the points within the tolerance, ascending
  double rms = 0;            ///< [mm] of their distances from the shape
};

struct CloudPlane : PointsOnShape {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< [mm] the centroid of the inliers
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit; its largest coordinate is positive
};

struct CloudSphere : PointsOnShape {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< [mm]
  double radius = 0;                                 ///< [mm]
};

struct CloudCylinder : PointsOnShape {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< [mm] on the axis, amid the inliers
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();   ///< unit; its largest coordinate is positive
  double radius = 0;                                ///< [mm]
  double length = 0;                                ///< [mm] of the inliers along the axis
};

/// The largest plane; none if no plane has `min_share` of the points, or these are on a line.
[[nodiscard]] std::optional<CloudPlane> find_plane(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                                   const CloudShapeOptions& options);

/// The largest sphere; none if no sphere has `min_share` of the points.
[[nodiscard]] std::optional<CloudSphere> find_sphere(
    const Eigen::Ref<const Eigen::Matrix3Xd>& points, const CloudShapeOptions& options);

/// The largest cylinder (of any length); none if no cylinder has `min_share` of the points.
/// \param normals 3 x N, as from `cloud_normals`; their side does not matter, and they need not be
/// exact. Points whose normal is not finite can be on the cylinder, but do not propose any.
/// \throws InvalidInput also unless there are as many normals as points.
[[nodiscard]] std::optional<CloudCylinder> find_cylinder(
    const Eigen::Ref<const Eigen::Matrix3Xd>& points,
    const Eigen::Ref<const Eigen::Matrix3Xd>& normals, const CloudShapeOptions& options);

}  // namespace palpate::geometry
