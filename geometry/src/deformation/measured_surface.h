// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/range_map.h"

namespace palpate::geometry {

/// The tangent plane at a pixel.
struct MeasuredPlane {
  Eigen::Vector3d point;  ///< [mm] measured, camera frame; NaN without a depth
  Eigen::Vector3d
      normal;  ///< unit, towards the camera; NaN if too few neighbours are on the surface
};

/// A range map as points with normals, for projective association.
class MeasuredSurface {
 public:
  /// \throws InvalidInput if the camera is not valid or has another size.
  explicit MeasuredSurface(const RangeMap& map);

  /// The pixel (row * cols + col) that shows a point, -1 if none does. Returns `before` (a pixel or
  /// -1) if the point is at most a pixel away from it, so that a point that moves little keeps its
  /// pixel.
  [[nodiscard]] int pixel_of(const Eigen::Vector3d& point, int before = -1) const;
  [[nodiscard]] MeasuredPlane at(int pixel) const {
    return {points_.col(pixel), normals_.col(pixel)};
  }

 private:
  void fit_normal(Eigen::Index row, Eigen::Index col);

  Camera camera_;
  Eigen::Matrix2Xd rays_;
  Eigen::Matrix3Xd points_;
  Eigen::Matrix3Xd normals_;
};

}  // namespace palpate::geometry
