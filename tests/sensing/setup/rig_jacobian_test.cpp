// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "setup/rig_jacobian.h"

#include <gtest/gtest.h>

#include <cmath>

#include "setup/moved_rig.h"
#include "setup/triangulation.h"

namespace palpate::sensing {
namespace {

const Eigen::Matrix2Xd kPixels = (Eigen::Matrix2Xd(2, 3) << 60, 310, 590, 410, 225, 33).finished();
const Eigen::Vector3d kInverseDepth(1 / 430.0, 1 / 520.0, 1 / 610.0);

TEST(RigJacobian, IsTheSlopeOfTheProjectorsPixelInEveryParameter) {
  const Rig rig = make_verging_rig();
  for (const Axis axis : {Axis::x, Axis::y}) {
    const PanelView view = panel_view(rig, axis, look_back(rig.camera, kPixels), kInverseDepth);
    const auto pixel = [&](const Rig& other, Eigen::Index i, double w) {
      const Triangulation triangulation(other);
      return triangulation.project(
          triangulation.direction(geometry::undistort(other.camera, kPixels.col(i))),
          1 / w)[axis == Axis::x ? 0 : 1];
    };
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double w = kInverseDepth[i];
      EXPECT_NEAR(view.by_inverse_depth[i],
                  (pixel(rig, i, w * 1.0001) - pixel(rig, i, w * 0.9999)) / (2e-4 * w),
                  1e-5 * std::abs(view.by_inverse_depth[i]));
      for (int p = 0; p < kRigParameters; ++p) {
        const double step = p < 18 && p % 9 >= 4 ? 1e-5 : p >= 18 && p < 21 ? 1e-6 : 1e-3;
        const double slope =
            (pixel(moved_rig(rig, p, step), i, w) - pixel(moved_rig(rig, p, -step), i, w)) /
            (2 * step);
        EXPECT_NEAR(view.by_rig(i, p), slope, 1e-4 * std::abs(slope) + 1e-6) << p << ' ' << i;
      }
    }
  }
}

TEST(RigJacobian, VarianceIsThatOfTheTriangulatedDepth) {
  // Two parameters that always change together: fy of the projector and the y of t.
  constexpr double kFocal = 0.3, kShift = 0.05;
  Rig rig = make_verging_rig();
  rig.covariance = RigCovariance::Zero();
  (*rig.covariance)(10, 10) = kFocal * kFocal;
  (*rig.covariance)(22, 22) = kShift * kShift;
  (*rig.covariance)(10, 22) = (*rig.covariance)(22, 10) = kFocal * kShift;
  const PanelView view = panel_view(rig, Axis::y, look_back(rig.camera, kPixels), kInverseDepth);
  const Eigen::VectorXd variance = inverse_depth_variance(rig, view);
  const Triangulation exact(rig);
  const Triangulation moved(moved_rig(moved_rig(rig, 10, kFocal), 22, kShift));
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::Vector3d ray = exact.direction(geometry::undistort(rig.camera, kPixels.col(i)));
    const double lit_by = exact.project(ray, 1 / kInverseDepth[i]).y();
    const double shift = std::abs(1 / moved.depth(ray, Axis::y, lit_by) - kInverseDepth[i]);
    EXPECT_NEAR(std::sqrt(variance[i]), shift, 0.01 * shift);
  }
}

TEST(RigJacobian, IsUnknownFarBesideThePanel) {
  const Rig rig = make_verging_rig();
  const PanelView view = panel_view(rig, Axis::y, look_back(rig.camera, kPixels.leftCols(1)),
                                    Eigen::VectorXd::Constant(1, 1 / 20.0));
  EXPECT_TRUE(std::isnan(view.by_inverse_depth[0]));
}

}  // namespace
}  // namespace palpate::sensing
