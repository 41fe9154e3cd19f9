// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/camera.h"

namespace palpate::sensing {

inline constexpr int kLensParameters = 9;  ///< fx fy cx cy k1 k2 p1 p2 k3
inline constexpr int kMoveParameters = 6;  ///< rotation [rad], then translation [mm]

/// Pixels of points, and their derivatives, two rows per point.
struct LensView {
  Eigen::Matrix2Xd predicted;  ///< 2 x N [px]
  Eigen::MatrixXd by_lens;     ///< 2N x 9, by the lens' parameters
  Eigen::MatrixXd by_move;     ///< 2N x 6: by a rotation of the points about the lens, then a shift
};

/// `points`: 3 x N in the lens' frame, z > 0. k4 k5 k6 count as zero.
[[nodiscard]] LensView look(const geometry::Camera& lens, const Eigen::Matrix3Xd& points);

/// Rays of pixels, and their change with the lens' parameters at fixed pixels.
struct RayView {
  Eigen::Matrix3Xd rays;    ///< 3 x N: (x, y, 1); NaN where the lens has no ray
  Eigen::MatrixXd by_lens;  ///< 2N x 9: of x and y
};
[[nodiscard]] RayView look_back(const geometry::Camera& lens, const Eigen::Matrix2Xd& pixels);

}  // namespace palpate::sensing
