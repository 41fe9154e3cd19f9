// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <span>

namespace palpate::geometry {

/// Shapes as `find_shape` needs them, in a frame in which points lie in about [-1, 1].
struct PlaneModel {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;  ///< unit

  [[nodiscard]] double distance(const Eigen::Vector3d& p) const {
    return std::abs(normal.dot(p - point));
  }
};

struct SphereModel {
  Eigen::Vector3d centre;
  double radius;

  [[nodiscard]] double distance(const Eigen::Vector3d& p) const {
    return std::abs((p - centre).norm() - radius);
  }
};

struct CylinderModel {
  Eigen::Vector3d point;
  Eigen::Vector3d axis;  ///< unit
  double radius;

  [[nodiscard]] double distance(const Eigen::Vector3d& p) const {
    return std::abs(axis.cross(p - point).norm() - radius);
  }
};

/// Shapes through points; none if the points do not determine one.
[[nodiscard]] std::optional<PlaneModel> plane_through(std::span<const Eigen::Vector3d, 3> points);
[[nodiscard]] std::optional<SphereModel> sphere_through(std::span<const Eigen::Vector3d, 4> points);
/// The axis is perpendicular to both normals, and as near as can be to both lines along them
/// (Schnabel, Wahl and Klein 2007).
[[nodiscard]] std::optional<CylinderModel> cylinder_through(
    std::span<const Eigen::Vector3d, 2> points, std::span<const Eigen::Vector3d, 2> normals);

/// Shapes of least squares of the distances of points (3 x N), from a first one near them; none if
/// the points do not determine one. The cylinder's point is amid the points along the axis.
[[nodiscard]] std::optional<PlaneModel> fitted(const PlaneModel& first,
                                               const Eigen::Matrix3Xd& points);
[[nodiscard]] std::optional<SphereModel> fitted(const SphereModel& first,
                                                const Eigen::Matrix3Xd& points);
[[nodiscard]] std::optional<CylinderModel> fitted(const CylinderModel& first,
                                                  const Eigen::Matrix3Xd& points);

}  // namespace palpate::geometry
