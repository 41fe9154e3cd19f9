// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/surface_map.h"

namespace palpate::geometry {

/// Moves points, 3 x N [mm], by a smooth map that takes the source's landmarks to the target's: a
/// least-squares similarity, then the affine map and the thin-plate spline (kernel r) of least norm
/// for the remaining error. Precondition: at least three finite pairs that are not collinear.
[[nodiscard]] Eigen::Matrix3Xd warp_by_landmarks(const Eigen::Matrix3Xd& points,
                                                 const Landmarks& landmarks);

}  // namespace palpate::geometry
