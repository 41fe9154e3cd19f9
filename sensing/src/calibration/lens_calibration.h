// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "palpate/geometry/camera.h"

namespace palpate::sensing {

/// A lens, and the poses of the boards in front of it.
struct LensCalibration {
  geometry::Camera lens;
  std::array<double, 9> deviation{};  ///< of fx fy cx cy k1 k2 p1 p2 k3
  std::vector<Eigen::Isometry3d> T_lens_board;
  double rms = 0;  ///< px, root of the mean squared length of the residuals
};

/// Calibrates a lens with the image size of `lens` from flat boards (Zhang 2000): board points [mm]
/// in z = 0 and their pixels, one pair of matrices per view. `distortion_terms` is 0, 2, 4 or 5.
/// \throws SolverError if the views are insufficient, so that the result is not finite.
[[nodiscard]] LensCalibration calibrate_lens(const std::vector<Eigen::Matrix2Xd>& board,
                                             const std::vector<Eigen::Matrix2Xd>& pixels,
                                             const geometry::Camera& lens, int distortion_terms);

}  // namespace palpate::sensing
