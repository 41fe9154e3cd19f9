// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace palpate::geometry {

/// A frame in which points lie in about [-1, 1]: centred on their bounding box and scaled by a
/// power of two, which is exact.
struct LocalFrame {
  Eigen::Vector3d centre;
  double scale;  ///< local = (world - centre) * scale

  [[nodiscard]] Eigen::Matrix3Xd to_local(const Eigen::Matrix3Xd& world) const {
    return (world.colwise() - centre) * scale;
  }
};

/// Precondition: at least one point, all finite.
[[nodiscard]] inline LocalFrame local_frame(const Eigen::Matrix3Xd& points) {
  // Use halves, because the whole extent may overflow.
  const Eigen::Vector3d lower = points.rowwise().minCoeff() / 2;
  const Eigen::Vector3d upper = points.rowwise().maxCoeff() / 2;
  const double half_extent = (upper - lower).maxCoeff();
  // Keep the scale and its inverse normal numbers.
  constexpr int kMaxExponent = 1000;
  const int exponent = half_extent > 0 ? std::ilogb(half_extent) + 1 : 0;
  return {.centre = lower + upper,
          .scale = std::ldexp(1.0, -std::clamp(exponent, -kMaxExponent, kMaxExponent))};
}

}  // namespace palpate::geometry
