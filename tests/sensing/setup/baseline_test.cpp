// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "setup/baseline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

TEST(Baseline, ItsPartsAreThoseOfADirection) {
  Rig rig = make_rig(false);
  rig.T_projector_camera.translation() = Eigen::Vector3d(60, 190, 0);
  const Eigen::Array2d parts = parts_of_baseline(rig);
  EXPECT_NEAR(parts.x(), 60 / std::hypot(60, 190), 1e-12);
  EXPECT_NEAR(parts.y(), 190 / std::hypot(60, 190), 1e-12);
}

TEST(Baseline, ASinusoidShowsStepsIfHalfOfItLiesAlong) {
  Rig rig = make_rig(false);
  for (const double degrees : {0.0, 59.0, -59.0, 121.0, 61.0, 90.0, -61.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    rig.T_projector_camera.translation() =
        200 * Eigen::Vector3d(std::sin(angle), std::cos(angle), 0);
    EXPECT_EQ(shows_steps(rig, Axis::y), std::abs(std::cos(angle)) > 0.5) << degrees;
    EXPECT_EQ(shows_steps(rig, Axis::x), std::abs(std::sin(angle)) > 0.5) << degrees;
  }
}

}  // namespace
}  // namespace palpate::sensing
