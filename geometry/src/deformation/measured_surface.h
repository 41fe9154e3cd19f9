// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/geometry/range_map.h"

namespace palpate::geometry {

/// Least deviation of depths [px], for depths without noise: pixels sample the surface.
inline constexpr double kLeastDepthNoise = 0.05;

/// The tangent plane at a pixel.
struct MeasuredPlane {
  Eigen::Vector3d point;  ///< [mm] measured, camera frame; NaN without a depth
  Eigen::Vector3d
      normal;  ///< unit, towards the camera; NaN if too few neighbours are on the surface
  bool at_border = false;  ///< of the measured surface, or at a step: the depth may be biased
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
    return {points_.col(pixel), normals_.col(pixel),
            at_border_[static_cast<std::size_t>(pixel)] != 0};
  }

 private:
  void fit_normal(Eigen::Index row, Eigen::Index col);
  void find_border(Eigen::Index row, Eigen::Index col);
  template <typename Visit>
  void visit_neighbours(Eigen::Index row, Eigen::Index col, Eigen::Index window,
                        Visit&& visit) const;

  Camera camera_;
  Eigen::Matrix2Xd rays_;
  Eigen::Matrix3Xd points_;
  Eigen::Matrix3Xd normals_;
  std::vector<char> at_border_;
};

}  // namespace palpate::geometry
