// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "setup/rig_jacobian.h"

#include <Eigen/Geometry>
#include <limits>

namespace palpate::sensing {
namespace {

/// Returns true if a pixel lies on the panel or a little beside it.
bool is_near_panel(const geometry::Camera& lens, const Eigen::Vector2d& pixel) {
  constexpr double kBeside = 0.2;  // of the panel's size
  const double dx = kBeside * lens.width;
  const double dy = kBeside * lens.height;
  return pixel.x() >= -dx && pixel.y() >= -dy && pixel.x() <= lens.width + dx &&
         pixel.y() <= lens.height + dy;
}

}  // namespace

PanelView panel_view(const Rig& rig, Axis axis, const RayView& seen,
                     const Eigen::VectorXd& inverse_depth) {
  const Eigen::Index row = axis == Axis::x ? 0 : 1;
  const Eigen::Matrix3d R = rig.T_projector_camera.linear();
  const Eigen::Matrix3Xd turned = R * seen.rays * inverse_depth.cwiseInverse().asDiagonal();
  const Eigen::Matrix3Xd points = turned.colwise() + rig.T_projector_camera.translation();
  const LensView shown = look(rig.projector, points);
  PanelView view{Eigen::VectorXd(points.cols()), Eigen::MatrixXd(points.cols(), kRigParameters)};
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (!(points(2, i) > 0) || !is_near_panel(rig.projector, shown.predicted.col(i))) {
      view.by_inverse_depth[i] = std::numeric_limits<double>::quiet_NaN();
      view.by_rig.row(i).setConstant(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const double w = inverse_depth[i];
    const Eigen::RowVector3d by_point = shown.by_move.block<1, 3>(2 * i + row, 3);
    const Eigen::RowVector3d by_ray = by_point * R / w;
    view.by_inverse_depth[i] = -by_point.dot(turned.col(i).transpose()) / w;
    view.by_rig.row(i).head<kLensParameters>() =
        by_ray.head<2>() * seen.by_lens.middleRows<2>(2 * i);
    view.by_rig.row(i).segment<kLensParameters>(kLensParameters) = shown.by_lens.row(2 * i + row);
    // A turn by w moves a point by w x (R X), so the derivative is (R X) x by_point.
    view.by_rig.row(i).segment<3>(2 * kLensParameters) =
        Eigen::Vector3d(turned.col(i)).cross(by_point.transpose()).transpose();
    view.by_rig.row(i).tail<3>() = by_point;
  }
  return view;
}

Eigen::VectorXd inverse_depth_variance(const Rig& rig, const PanelView& view) {
  const Eigen::MatrixXd weighted = view.by_rig * *rig.covariance;
  return weighted.cwiseProduct(view.by_rig)
      .rowwise()
      .sum()
      .cwiseQuotient(view.by_inverse_depth.cwiseAbs2());
}

}  // namespace palpate::sensing
