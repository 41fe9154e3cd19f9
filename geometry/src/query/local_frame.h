// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "palpate/geometry/mesh_measures.h"

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

/// Precondition: the box is not empty, and finite.
[[nodiscard]] inline LocalFrame local_frame(const Eigen::AlignedBox3d& box) {
  // Use halves, because the whole extent may overflow.
  const Eigen::Vector3d lower = box.min() / 2;
  const Eigen::Vector3d upper = box.max() / 2;
  const double half_extent = (upper - lower).maxCoeff();
  // Keep the scale and its inverse normal numbers.
  constexpr int kMaxExponent = 1000;
  const int exponent = half_extent > 0 ? std::ilogb(half_extent) + 1 : 0;
  return {.centre = lower + upper,
          .scale = std::ldexp(1.0, -std::clamp(exponent, -kMaxExponent, kMaxExponent))};
}

/// A place to be subtracted from all points of a box without rounding: the box's middle on axes on
/// which coordinates differ by at most a factor of two (Sterbenz 1974). On others it is 0, because
/// no coordinate is more than twice as large as the box is.
[[nodiscard]] inline Eigen::Vector3d exact_offset(const Eigen::AlignedBox3d& box) {
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const double lower = box.min()[axis], upper = box.max()[axis];
    if (lower > 0 ? upper <= 2 * lower : upper < 0 && lower >= 2 * upper)
      offset[axis] = lower + (upper - lower) / 2;
  }
  return offset;
}

}  // namespace palpate::geometry
