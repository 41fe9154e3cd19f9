// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "setup/carrier.h"

#include <gtest/gtest.h>

#include <numbers>

#include "palpate/core/error.h"
#include "synthetic_scene.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

constexpr double kCarrierRounding = 1e-9;

/// With parallel axes and the projector as far forward as the camera the image of a facing plane is
/// the pattern, scaled by the ratio of the focal lengths at any depth.
Rig level_rig() {
  Rig rig = make_rig(false);
  rig.T_projector_camera.translation().z() = 0;
  return rig;
}

TEST(Carrier, IsTheRatioOfTheFocalLengthsWithParallelAxes) {
  const Carrier carrier = expected_carrier(level_rig(), make_pattern(Axis::y, 11, 1024));
  EXPECT_FALSE(carrier.transposed);
  EXPECT_FALSE(carrier.stripes_reversed);
  EXPECT_NEAR(carrier.along, 2 * std::numbers::pi * 1500 / 550 / 11, kCarrierRounding);
  EXPECT_NEAR(carrier.across, 0, kCarrierRounding);
  EXPECT_GT(carrier.z, 222);  // a baseline
}

TEST(Carrier, ASinusoidAlongXWorksOnTheTransposedImage) {
  const Carrier carrier = expected_carrier(level_rig(), make_pattern(Axis::x, 11, 768));
  EXPECT_TRUE(carrier.transposed);
  EXPECT_NEAR(carrier.along, 2 * std::numbers::pi * 1500 / 550 / 11, kCarrierRounding);
}

TEST(Carrier, AProjectorUpsideDownReversesSinusoidAndStripes) {
  Rig rig = level_rig();
  const Eigen::Matrix3d half_turn =
      Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  rig.T_projector_camera.linear() = half_turn;
  rig.T_projector_camera.translation() = half_turn * rig.T_projector_camera.translation();
  rig.projector.cx = 1023 - rig.projector.cx;
  rig.projector.cy = 767 - rig.projector.cy;
  const Carrier carrier = expected_carrier(rig, make_pattern(Axis::y, 11, 1024));
  EXPECT_NEAR(carrier.along, -2 * std::numbers::pi * 1500 / 550 / 11, kCarrierRounding);
  EXPECT_TRUE(carrier.stripes_reversed);
}

TEST(Carrier, ViewsThatDoNotOverlapAreRefused) {
  Rig rig = make_rig(false);
  rig.T_projector_camera.linear() =
      Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_THROW((void)expected_carrier(rig, make_pattern(Axis::y, 10, 1024)), InvalidInput);
}

TEST(Carrier, APeriodThatTheCameraCannotSeeIsRefused) {
  for (const double period : {0.01, 1e3, 1e12, 1e300}) {
    EXPECT_NE(message_of<InvalidInput>([&] {
                (void)expected_carrier(level_rig(), make_pattern(Axis::y, period, 1024));
              }).find("period_px"),
              std::string::npos)
        << period;
  }
}

}  // namespace
}  // namespace palpate::sensing
