// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/tool_radius.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "not_finite.h"
#include "palpate/probing/contact_equilibrium.h"
#include "refusal.h"

namespace palpate::haptics {
namespace {

// [N] on a ball 1 mm deep in a block of finite elements.
double force_on_ball(double radius) {
  probing::DeformableBody body;
  const std::vector<double> across{-20, -12, -7, -3.5, 0, 3.5, 7, 12, 20};
  body.mesh = probing::box_mesh(across, across, {0, 3, 8, 18});
  body.materials = {{.shear_modulus = 0.03, .bulk_modulus = 0.3}};
  for (int n = 0; n < body.mesh.nodes.cols(); ++n)
    if (body.mesh.nodes(2, n) == 18) body.supported.push_back(n);
  const probing::ContactEquilibrium solid(std::move(body), {.tip_radius = radius, .friction = 0});
  const probing::ContactState start =
      solid.touch(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ());
  const probing::ContactResult pressed =
      solid.move_tip(start, start.tip + Eigen::Vector3d::UnitZ());
  EXPECT_EQ(pressed.stop, probing::ContactStop::converged);
  return pressed.state.force.z();
}

TEST(ToolRadius, IsMissedByWhatASolidOfFiniteElementsShows) {
  const double probe = force_on_ball(5);
  EXPECT_GT(probe, 0.1);
  EXPECT_NEAR(missing_force(5, 10), force_on_ball(10) / probe - 1, 0.06);
  EXPECT_NEAR(missing_force(5, 3), force_on_ball(3) / probe - 1, 0.06);
}

TEST(ToolRadius, NothingIsMissingForTheProbesOwn) { EXPECT_EQ(missing_force(4, 4), 0); }

TEST(ToolRadius, RefusesRadiiThatAreNone) {
  for (const double wrong : {0.0, -1.0, kInf, kNaN}) {
    EXPECT_THAT(refusal([&] { return missing_force(wrong, 5); }),
                ::testing::HasSubstr("probe_radius"));
    EXPECT_THAT(refusal([&] { return missing_force(5, wrong); }),
                ::testing::HasSubstr("tool_radius"));
  }
}

}  // namespace
}  // namespace palpate::haptics
