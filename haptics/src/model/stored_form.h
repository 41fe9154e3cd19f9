// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

// The numbers by which the field document stores frames, axes and ridges. After any rounding they
// still represent a rotation, a unit vector, or a ridge along a unit vector. Conversion in both
// directions changes only the last bits.

/// A ridge as weight sqrt((slope . x - offset)^2 + 1): weight [N mm], slope [1/mm].
struct StoredRidge {
  double weight = 0;
  double offset = 0;
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();
};

/// The length of a slope, without overflow. `stableNorm` of Eigen rounds differently where a vector
/// begins at an odd multiple of 8 bytes.
[[nodiscard]] double length_of(const Eigen::Vector3d& slope);
/// Converts a base that is a ridge.
[[nodiscard]] StoredRidge to_stored(const Multiquadric& ridge);
/// The centre of the result lies along the ridge. The slope must not be zero.
[[nodiscard]] Multiquadric to_ridge(const StoredRidge& stored);
/// Rounds to `kFieldDigits` digits; all entries of the slope get as many decimal places as give its
/// largest one this many digits, or one more.
[[nodiscard]] StoredRidge rounded(StoredRidge stored);

/// Quaternion w, x, y, z whose entry of largest magnitude is 1.
[[nodiscard]] Eigen::Vector4d to_quaternion(const Eigen::Matrix3d& frame);
/// From a quaternion w, x, y, z of any length but zero.
[[nodiscard]] Eigen::Matrix3d to_frame(const Eigen::Vector4d& quaternion);

/// Direction of a unit vector, scaled so that its entry of largest magnitude is 1 or -1.
[[nodiscard]] Eigen::Vector3d to_direction(const Eigen::Vector3d& axis);

/// Rounds the entries to `kFieldDigits` decimal places.
[[nodiscard]] Eigen::Vector4d rounded(const Eigen::Vector4d& quaternion);
[[nodiscard]] Eigen::Vector3d rounded(const Eigen::Vector3d& direction);

}  // namespace palpate::haptics
