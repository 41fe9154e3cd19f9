// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

// The numbers that the field document tells of frames, axes and ridges: as few as there are degrees
// of freedom. Whatever they are rounded to, they stand for a rotation, a unit vector, a ridge along
// a unit vector. Going there and back changes nothing but for rounding of the last bits.

/// A ridge as weight sqrt((slope . x - offset)^2 + 1): weight [N mm], slope [1/mm].
struct StoredRidge {
  double weight = 0;
  double offset = 0;
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();
};

/// Of a base that is a ridge.
[[nodiscard]] StoredRidge to_stored(const Multiquadric& ridge);
/// Its centre lies along the ridge. The slope must not be zero.
[[nodiscard]] Multiquadric to_ridge(const StoredRidge& stored);
/// The same, with `kFieldDigits` digits; the slope's entries with as many decimal places as give
/// its largest one so many, or one more.
[[nodiscard]] StoredRidge rounded(StoredRidge stored);

/// w, x, y, z of a quaternion whose entry of largest magnitude is 1.
[[nodiscard]] Eigen::Vector4d to_quaternion(const Eigen::Matrix3d& frame);
/// w, x, y, z of any length but zero.
[[nodiscard]] Eigen::Matrix3d to_frame(const Eigen::Vector4d& quaternion);

/// Along a unit vector, with an entry of largest magnitude of 1 or -1.
[[nodiscard]] Eigen::Vector3d to_direction(const Eigen::Vector3d& axis);

/// Their entries with `kFieldDigits` decimal places.
[[nodiscard]] Eigen::Vector4d rounded(const Eigen::Vector4d& quaternion);
[[nodiscard]] Eigen::Vector3d rounded(const Eigen::Vector3d& direction);

}  // namespace palpate::haptics
