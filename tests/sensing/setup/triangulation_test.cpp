// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "setup/triangulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

/// 10 operations in double precision on values near 1000.
constexpr double kTriangulationRounding = 1e-9;

TEST(Triangulation, ParallelAxesGiveTheThesisEquations) {
  const Rig rig = make_rig(false);
  const Eigen::Vector3d p = -rig.T_projector_camera.translation();  // the projector's centre
  const Triangulation triangulation(rig);
  const Eigen::Vector2d ci(0.12, -0.07);
  const Eigen::Vector3d ray = triangulation.direction(ci);
  // Eq. 3.2
  const double pi_x = 0.31;
  const double z_stripe = (p.x() - pi_x * p.z()) / (ci.x() - pi_x);
  EXPECT_NEAR(triangulation.depth(ray, Axis::x, rig.projector.fx * pi_x + rig.projector.cx),
              z_stripe, kTriangulationRounding);
  // Eqs. 3.9 and 3.11, omega in radians per normalised coordinate
  const double omega = 940;
  const double theta = 231.7;
  const double pi_y = ci.y() - theta / omega;
  const double z_phase = omega * (-p.z() * ci.y() + p.y()) / theta + p.z();
  ASSERT_LT(z_phase, 0);  // theta of this sign lies behind the camera
  EXPECT_TRUE(
      std::isnan(triangulation.depth(ray, Axis::y, rig.projector.fy * pi_y + rig.projector.cy)));
  const double pi_y_front = ci.y() + theta / omega;
  const double z_front = omega * (-p.z() * ci.y() + p.y()) / -theta + p.z();
  EXPECT_NEAR(triangulation.depth(ray, Axis::y, rig.projector.fy * pi_y_front + rig.projector.cy),
              z_front, kTriangulationRounding);
}

TEST(Triangulation, DepthUndoesProjectionForAnyPoseAndLens) {
  Rig rig = make_rig(true);
  for (const bool distorted : {false, true}) {
    if (distorted) rig.projector.distortion = {-0.08, 0.12, 1e-3, -2e-3, -0.05, 0, 0, 0};
    const Triangulation triangulation(rig);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> coordinate(-0.25, 0.25);
    std::uniform_real_distribution<double> depth(400, 1500);
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d ray = triangulation.direction({coordinate(random), coordinate(random)});
      const double z = depth(random);
      const Eigen::Vector2d pixel = triangulation.project(ray, z);
      if (!triangulation.on_panel(pixel)) continue;
      // The secant method stops within 1e-6 px; a pixel is at most about 10 mm here.
      const double tolerance = distorted ? 1e-5 : kTriangulationRounding;
      EXPECT_NEAR(triangulation.depth(ray, Axis::x, pixel.x()), z, tolerance);
      EXPECT_NEAR(triangulation.depth(ray, Axis::y, pixel.y()), z, tolerance);
    }
  }
}

TEST(Triangulation, SlopeIsTheDerivative) {
  const Triangulation triangulation(make_rig(true));
  const Eigen::Vector3d ray = triangulation.direction({0.1, -0.05});
  const double step = 1e-3;
  const Eigen::Vector2d difference =
      (triangulation.project(ray, 800 + step) - triangulation.project(ray, 800 - step)) /
      (2 * step);
  EXPECT_NEAR(triangulation.slope(ray, Axis::x, 800), difference.x(), 1e-8);
  EXPECT_NEAR(triangulation.slope(ray, Axis::y, 800), difference.y(), 1e-8);
}

TEST(Triangulation, ThePhaseSaysNothingOnTheSingularLine) {
  Rig rig = make_rig(false);
  rig.T_projector_camera.translation() = Eigen::Vector3d(100, 10, -100);
  const Triangulation triangulation(rig);
  const double ci_y = 10.0 / -100.0 * -1 * -1;  // p_y / p_z, p = -t
  const Eigen::Vector3d ray = triangulation.direction({0.05, ci_y});
  EXPECT_NEAR(triangulation.slope(ray, Axis::y, 700), 0, 1e-12);
}

TEST(Triangulation, NothingIsLitBehindTheProjector) {
  Rig rig = make_rig(false);
  rig.T_projector_camera.translation() = Eigen::Vector3d(100, 10, -500);
  const Triangulation triangulation(rig);
  const Eigen::Vector3d ray = triangulation.direction({0, 0});
  EXPECT_TRUE(triangulation.project(ray, 400).hasNaN());
  EXPECT_FALSE(triangulation.on_panel(triangulation.project(ray, 400)));
  EXPECT_FALSE(triangulation.project(ray, 600).hasNaN());
}

}  // namespace
}  // namespace palpate::sensing
