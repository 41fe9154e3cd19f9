// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/acquisition/virtual_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "palpate/geometry/surface_query.h"
#include "refusal.h"
#include "seeing_testing.h"

namespace palpate::acquisition {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

Rest pressed(long long trial = 3) {
  const Vector3d at(5, -8, 700), force(0.3, 0, 1.2);
  const Vector3d tip = at + support::soft_body()->displacement(at, force);
  return {.trial = trial,
          .tool = {tip, Vector3d::UnitZ()},
          .truth = probing::TrueLoad{.contact = at, .force = force, .tip = tip}};
}

TEST(VirtualCamera, SeesTheDeformedObjectBehindTheTool) {
  const Rest rest = pressed();
  const RestPicture seen =
      make_virtual_camera(support::soft_body(), support::bundled_setup())->look(rest);
  EXPECT_EQ(seen.frame.size(), cv::Size(640, 480));
  ASSERT_TRUE(seen.truth);
  const geometry::SurfaceQuery deformed(geometry::TriangleMesh{
      .vertices = support::soft_body()->deformed_surface(rest.truth->contact, rest.truth->force),
      .triangles = support::soft_body()->surface().triangles});
  const Eigen::Matrix2Xd rays = geometry::pixel_rays(seen.truth->camera);
  const geometry::PixelMask hidden = hidden_by_tool(rays, 480, {}, rest.tool, 0);
  int compared = 0;
  for (int v = 100; v < 400; v += 13) {
    for (int u = 200; u < 440; u += 11) {
      if (hidden(v, u)) {
        EXPECT_TRUE(std::isnan(seen.truth->z(v, u))) << u << ", " << v;
        continue;
      }
      const Vector3d far = 1000 * rays.col(v * 640 + u).homogeneous();
      const auto hit = deformed.first_hit(Vector3d::Zero(), far);
      if (!hit || std::isnan(seen.truth->z(v, u))) continue;  // beside the object; facets' border
      EXPECT_NEAR(seen.truth->z(v, u), hit->position.z(), 1e-3) << u << ", " << v;
      ++compared;
    }
  }
  EXPECT_GT(compared, 100);
}

TEST(VirtualCamera, HasTheNoiseOfTheTrial) {
  const auto camera = make_virtual_camera(support::soft_body(), support::bundled_setup());
  const cv::Mat first = camera->look(pressed()).frame, again = camera->look(pressed()).frame,
                other = camera->look(pressed(4)).frame;
  EXPECT_EQ(cv::norm(first, again, cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(first, other, cv::NORM_INF), 0);
}

TEST(VirtualCamera, RefusesWhatItCannotSee) {
  const std::shared_ptr<const probing::Specimen> sheet = probing::make_specimen(probing::Sheet{});
  EXPECT_THAT(refusal([&] { return make_virtual_camera(sheet, support::bundled_setup()); }),
              HasSubstr("elastic_body and finite_elements"));
  const auto camera = make_virtual_camera(support::soft_body(), support::bundled_setup());
  EXPECT_THAT(refusal([&] { return camera->look({.trial = 0}); }), HasSubstr("does not report"));
}

}  // namespace
}  // namespace palpate::acquisition
