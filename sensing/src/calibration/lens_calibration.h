// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "palpate/geometry/camera.h"

namespace palpate::sensing {

/// One lens, and where the boards stood before it.
struct LensCalibration {
  geometry::Camera lens;
  std::array<double, 9> deviation{};  ///< of fx fy cx cy k1 k2 p1 p2 k3
  std::vector<Eigen::Isometry3d> T_lens_board;
  double rms = 0;  ///< px, root of the mean squared length of the residuals
};

/// Calibrates a lens of the size of `lens` from flat boards (Zhang 2000): board points [mm] in
/// z = 0 and their pixels, one pair of matrices a view. `distortion_terms` is 0, 2, 4 or 5.
/// \throws SolverError if the views do not determine it so far that no numbers come out.
[[nodiscard]] LensCalibration calibrate_lens(const std::vector<Eigen::Matrix2Xd>& board,
                                             const std::vector<Eigen::Matrix2Xd>& pixels,
                                             const geometry::Camera& lens, int distortion_terms);

}  // namespace palpate::sensing
