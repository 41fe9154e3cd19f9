// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"
#include "setup/lens_jacobian.h"

namespace palpate::sensing {

/// The projector's coordinate along one axis that lights points on rays of the camera, and its
/// derivatives. Rows are NaN where the point lies behind the projector, or so far beside the panel
/// that the model of its lens is not valid.
struct PanelView {
  Eigen::VectorXd by_inverse_depth;  ///< N [px mm]
  Eigen::MatrixXd by_rig;            ///< N x 24, in the order of `RigCovariance`, at fixed depth
};

/// \param seen          N rays of the camera, from `look_back`.
/// \param inverse_depth N [1/mm], > 0.
[[nodiscard]] PanelView panel_view(const Rig& rig, Axis axis, const RayView& seen,
                                   const Eigen::VectorXd& inverse_depth);

/// Variance of the inverse depth of each point [1/mm^2] by the rig's covariance, at fixed pixels of
/// camera and projector: g C g^T with g = -(dx/dp) / (dx/dw). NaN as above.
/// \pre the rig has a covariance.
[[nodiscard]] Eigen::VectorXd inverse_depth_variance(const Rig& rig, const PanelView& view);

}  // namespace palpate::sensing
