// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace palpate::geometry {

// Exact signs for coordinates as they are stored. Precondition: all coordinates are 0 or between
// 1e-90 and 1e90 in size, so that no product overflows or underflows.

/// Side of the plane through a, b, c on which the point d lies: 1 if the three are clockwise seen
/// from it, -1 if they are counter-clockwise, 0 if it is in the plane.
[[nodiscard]] int orientation(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                              const Eigen::Vector3d& c, const Eigen::Vector3d& d);

/// Side of the line from a to b on which the point c lies: 1 on the left, -1 on the right, 0 on it.
[[nodiscard]] int orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                              const Eigen::Vector2d& c);

}  // namespace palpate::geometry
