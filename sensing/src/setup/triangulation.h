// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"

namespace palpate::sensing {

/// One coordinate of a projector pixel as a function of depth along a camera ray, and its inverse.
///
/// A ray is given by its direction d = R (x, y, 1) in projector coordinates: the point at camera
/// depth z is z d + t. A projector column, row or phase defines a plane through the projector's
/// centre (slightly curved with lens distortion), so the depth is a ray-plane intersection, the
/// general form of Eqs. 3.2 and 3.11.
class Triangulation {
 public:
  explicit Triangulation(const Rig& rig);

  /// R (x, y, 1) for a normalised image coordinate of the camera.
  [[nodiscard]] Eigen::Vector3d direction(const Eigen::Vector2d& normalized) const {
    return rotation_ * normalized.homogeneous();
  }
  /// Projector pixel that lights the point at depth z on a ray. NaN behind the projector.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& direction, double z) const;
  /// Depth at which a ray's projector pixel has the coordinate `pixel` along `axis`. NaN if there
  /// is no such depth > 0 in front of the projector.
  [[nodiscard]] double depth(const Eigen::Vector3d& direction, Axis axis, double pixel) const;
  /// d pixel / d z along `axis` at depth z, without lens distortion; zero on the singular line.
  [[nodiscard]] double slope(const Eigen::Vector3d& direction, Axis axis, double z) const;
  /// Returns true if a pixel lies on the projector's panel.
  [[nodiscard]] bool on_panel(const Eigen::Vector2d& pixel) const;

 private:
  [[nodiscard]] double plane_depth(const Eigen::Vector3d& direction, int row,
                                   double normalized) const;

  geometry::Camera projector_;
  bool distorted_ = false;
  Eigen::Matrix3d rotation_;
  Eigen::Vector3d translation_;
};

}  // namespace palpate::sensing
