// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// [mm] or [N]: nobody measures a longer length or a larger force, and a model file holds no larger
/// number. Squares and products of numbers within it are far from overflow.
inline constexpr double kLargestMeasurement = 1e12;

/// Returns true if all components are finite and at most `kLargestMeasurement` in size.
[[nodiscard]] inline bool is_measurable(const Eigen::Vector3d& vector) {
  return (vector.array().abs() <= kLargestMeasurement).all();  // false for NaN
}

}  // namespace palpate::probing
