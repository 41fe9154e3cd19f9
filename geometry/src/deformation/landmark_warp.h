// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/surface_map.h"

namespace palpate::geometry {

/// Points, 3 x N [mm], moved by a smooth map that takes the source's landmarks to the target's: a
/// similarity by least squares, then, of what that leaves, the affine map and the thin-plate spline
/// (kernel r) of least norm.
/// Pre: at least three pairs, finite, not in a line.
[[nodiscard]] Eigen::Matrix3Xd warp_by_landmarks(const Eigen::Matrix3Xd& points,
                                                 const Landmarks& landmarks);

}  // namespace palpate::geometry
