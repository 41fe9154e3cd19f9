// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "palpate/geometry/camera.h"

namespace palpate::sensing {

/// Observations of one view: points in the board's plane [mm] with their pixels, and pixels that
/// the projector lights on the board. Weights are >= 0, and 0 leaves a point out.
struct BundleView {
  Eigen::Matrix2Xd board;            ///< 2 x N [mm]
  Eigen::Matrix2Xd camera;           ///< 2 x N [px]
  Eigen::VectorXd camera_weight;     ///< N
  Eigen::Matrix2Xd lit_camera;       ///< 2 x M [px], pixels of the camera that see ...
  Eigen::Matrix2Xd projector;        ///< 2 x M [px], ... these points of the panel
  Eigen::VectorXd projector_weight;  ///< M
};

/// Estimated parameters.
struct Bundle {
  geometry::Camera camera;
  geometry::Camera projector;
  Eigen::Isometry3d T_projector_camera = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Isometry3d> T_camera_board;  ///< one per view
};

struct BundleOptions {
  int distortion_terms = 5;    ///< 0, 2, 4 or 5
  double camera_sigma = 1;     ///< px, > 0: standard deviation of a coordinate
  double projector_sigma = 1;  ///< px, > 0
  /// Smallest relative decrease of the cost that justifies a further step.
  double least_gain = 1e-12;
};

/// Observed minus predicted [px], 2 x N and 2 x M.
struct BundleResiduals {
  Eigen::Matrix2Xd camera;
  Eigen::Matrix2Xd projector;
};
[[nodiscard]] BundleResiduals bundle_residuals(const Bundle& bundle, const BundleView& view,
                                               std::size_t index);

/// Points of the board that pixels see: 3 x M in the camera's frame; NaN where a ray misses.
[[nodiscard]] Eigen::Matrix3Xd lit_points(const geometry::Camera& camera,
                                          const Eigen::Isometry3d& T_camera_board,
                                          const Eigen::Matrix2Xd& pixels);

/// Minimises the weighted sum of squared residuals divided by sigma (Levenberg-Marquardt). Each
/// view's pose is eliminated by an orthogonal factorisation of its own rows, so that the cost is
/// linear in the number of views.
/// \throws SolverError if the parameters become non-finite.
[[nodiscard]] Bundle refine_bundle(const Bundle& start, const std::vector<BundleView>& views,
                                   const BundleOptions& options);

/// Covariance of fx fy cx cy k1 k2 p1 p2 k3 of the camera, the same of the projector, then of a
/// rotation [rad] applied after R and of t [mm]: 24 x 24, zero where fixed; infinite if
/// undetermined.
[[nodiscard]] Eigen::MatrixXd bundle_covariance(const Bundle& bundle,
                                                const std::vector<BundleView>& views,
                                                const BundleOptions& options);

}  // namespace palpate::sensing
