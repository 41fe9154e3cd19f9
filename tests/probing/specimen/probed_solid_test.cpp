// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/probed_solid.h"

#include <gtest/gtest.h>

#include "palpate/core/error.h"
#include "solid_meshes.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

TEST(ProbedSolid, PlacesLieOnTheSurfaceThatTheCameraSeesAndPointInwards) {
  DeformableBody body;
  body.mesh = ball_mesh({0, 0, 720}, 20, 6);
  body.materials = {{}};
  palpate::support::support_where(body, [](const Vector3d& at) { return at.z() > 730; });
  const ProbedSolid ball(body, {});
  const ProbedPlace place = ball.place({5, -3, 690});
  const Vector3d outward = (place.position - Vector3d(0, 0, 720)).normalized();
  EXPECT_NEAR((place.position - Vector3d(0, 0, 720)).norm(), 20, 0.2);
  EXPECT_GT(-place.inward.dot(outward), 0.999);
  EXPECT_LT(ball.surface().vertices.row(2).maxCoeff(), 720);
  body.mesh.nodes.row(2).array() *= -1;  // behind the camera, and inverted
  EXPECT_THROW(ProbedSolid(body, {}), InvalidInput);
}

}  // namespace
}  // namespace palpate::probing
