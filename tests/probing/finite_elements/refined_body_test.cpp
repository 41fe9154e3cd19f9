// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "palpate/probing/contact_equilibrium.h"
#include "solid_meshes.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;
using palpate::support::evenly;

DeformableBody sheared_box() {
  DeformableBody body;
  body.mesh = box_mesh(evenly(0, 12, 2), evenly(0, 10, 2), evenly(0, 8, 2));
  body.mesh.regions.assign(body.mesh.regions.size(), 0);
  std::fill(body.mesh.regions.begin(), body.mesh.regions.begin() + 6, 1);
  body.materials = {{.shear_modulus = 0.1, .bulk_modulus = 1},
                    {.shear_modulus = 0.1, .bulk_modulus = 1}};
  palpate::support::support_where(body,
                                  [](const Vector3d& at) { return at.z() == 0 || at.z() == 8; });
  palpate::support::move_supports(body, [](const Vector3d& at) -> Vector3d {
    return {0.1 * at.z(), 0, 0};
  });
  return body;
}

TEST(RefinedBody, HasTheSameVolumeRegionsAndSupportsAsAFinerMesh) {
  const DeformableBody coarse = sheared_box(), fine = refined(coarse);
  EXPECT_EQ(fine.mesh.elements.cols(), 8 * coarse.mesh.elements.cols());
  EXPECT_NO_THROW(check_finite_element_mesh(fine.mesh));
  EXPECT_NEAR(volume(fine.mesh), volume(coarse.mesh), 1e-9 * volume(coarse.mesh));
  EXPECT_EQ(std::ranges::count(fine.mesh.regions, 1), 8 * 6);
  // Quadratic elements of half the size have nodes a quarter of the coarse cells apart.
  const FiniteElementMesh same = box_mesh(evenly(0, 12, 4), evenly(0, 10, 4), evenly(0, 8, 4));
  EXPECT_EQ(fine.mesh.nodes.cols(), same.nodes.cols());
  EXPECT_EQ(fine.supported.size(), 2U * 9 * 9);
  for (std::size_t k = 0; k < fine.supported.size(); ++k) {
    const Vector3d at = fine.mesh.nodes.col(fine.supported[k]);
    EXPECT_TRUE(at.z() == 0 || at.z() == 8) << at.transpose();
    EXPECT_LT((fine.support_moves.col(static_cast<Eigen::Index>(k)) - Vector3d(0.1 * at.z(), 0, 0))
                  .norm(),
              1e-12);
  }
}

TEST(RefinedBody, OfABallKeepsItsCurvedBoundary) {
  DeformableBody ball;
  ball.mesh = ball_mesh({1, 2, 3}, 10, 4);
  const DeformableBody fine = refined(ball);
  EXPECT_NO_THROW(check_finite_element_mesh(fine.mesh));
  // The quadrature of curved elements is not exact.
  EXPECT_NEAR(volume(fine.mesh), volume(ball.mesh), 1e-3 * volume(ball.mesh));
  EXPECT_EQ(boundary_faces(fine.mesh).size(), 4 * boundary_faces(ball.mesh).size());
}

TEST(RefinedBody, ConvergesToTheEnergyOfTheSolid) {
  const auto energy = [](DeformableBody body) {
    const ContactEquilibrium solid(std::move(body));
    return solid.elastic_energy(solid.rest());
  };
  const DeformableBody fine = refined(sheared_box());
  const double coarse = energy(sheared_box()), middle = energy(fine), last = energy(refined(fine));
  // Slowly: at the clamped edges, the stress is singular.
  EXPECT_LT(std::abs(last - middle), 0.9 * std::abs(middle - coarse));
  EXPECT_NEAR(coarse, last, 0.05 * last);
}

}  // namespace
}  // namespace palpate::probing
