// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/acquisition/tool_shape.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "palpate/geometry/camera.h"
#include "palpate/geometry/surface_query.h"
#include "refusal.h"

namespace palpate::acquisition {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

const ToolShape kShape{.radius = 4, .shaft = 30};
const ToolPose kPose{{12, -7, 690}, Vector3d(0.3, 0.2, 1).normalized()};

TEST(ToolShape, IsABallAtTheEndOfAShaft) {
  const geometry::TriangleMesh mesh = tool_mesh(kShape, kPose);
  double volume = 0;
  for (const auto triangle : mesh.triangles.colwise()) {
    volume += mesh.vertices.col(triangle[0])
                  .dot(mesh.vertices.col(triangle[1]).cross(mesh.vertices.col(triangle[2]))) /
              6;
  }
  const double exact = std::numbers::pi * (2.0 / 3 * 64 + 16 * 30);
  EXPECT_NEAR(volume, exact, 0.02 * exact);  // facets cut off a little; outwards: positive
  const Vector3d centre = kPose.tip - 4 * kPose.inward;
  for (const Vector3d vertex : mesh.vertices.colwise()) {
    const double along = (vertex - centre).dot(kPose.inward);
    EXPECT_LE(along, 4 + 1e-9);
    EXPECT_GE(along, -30 - 1e-9);
    const Vector3d nearest = centre + std::min(along, 0.0) * kPose.inward;
    EXPECT_LE((vertex - nearest).norm(), 4 + 1e-9);
  }
}

TEST(ToolShape, HidesThePixelsWhoseRaysHitIt) {
  const geometry::Camera camera{
      .width = 200, .height = 160, .fx = 1100, .fy = 1100, .cx = 99.5, .cy = 79.5};
  const Eigen::Matrix2Xd rays = geometry::pixel_rays(camera);
  const geometry::PixelMask hidden = hidden_by_tool(rays, camera.height, kShape, kPose, 0);
  const geometry::SurfaceQuery query(tool_mesh(kShape, kPose));
  int hit = 0, missed = 0, beside = 0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Vector3d ray = rays.col(v * camera.width + u).homogeneous();
      const bool hits = query.first_hit(Vector3d::Zero(), 1000 * ray).has_value();
      hit += hits;
      missed += hits && !hidden(v, u);
      beside += !hits && hidden(v, u);
    }
  }
  EXPECT_GT(hit, 100);
  EXPECT_EQ(missed, 0);
  EXPECT_LT(beside, 0.25 * hit);  // facets of the ball and the flat end of the shaft
}

TEST(ToolShape, HidesWhatIsNearItByTheMargin) {
  const geometry::Camera camera{
      .width = 201, .height = 3, .fx = 1000, .fy = 1000, .cx = 100, .cy = 1};
  // Straight away from the camera: the shaft begins at a depth of 500 mm.
  const ToolPose straight{{0, 0, 534}, Vector3d::UnitZ()};
  const Eigen::Matrix2Xd rays = geometry::pixel_rays(camera);
  const auto width = [&](double margin) {
    return hidden_by_tool(rays, camera.height, kShape, straight, margin).row(1).count();
  };
  EXPECT_EQ(width(0), 2 * 8 + 1);  // 4 mm at 500 mm are 8 px
  EXPECT_EQ(width(5), 2 * 18 + 1);
}

TEST(ToolShape, RefusesLengthsOutsideTheirRange) {
  EXPECT_THAT(refusal([] { return tool_mesh({.radius = 0}, kPose); }),
              HasSubstr("ToolShape::radius"));
  EXPECT_THAT(refusal([] { return tool_mesh({.radius = 1, .shaft = -1}, kPose); }),
              HasSubstr("ToolShape::shaft"));
  const Eigen::Matrix2Xd ray = Eigen::Matrix2Xd::Zero(2, 1);
  EXPECT_THAT(refusal([&] { return hidden_by_tool(ray, 1, kShape, kPose, -1); }),
              HasSubstr("margin"));
}

}  // namespace
}  // namespace palpate::acquisition
