// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/contact_system.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "solid_meshes.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;
using palpate::support::evenly;

TEST(ContactSystem, TheTipActsOnAllPointsWithinItsRadius) {
  constexpr double kRadius = 4;
  DeformableBody body;
  body.mesh = box_mesh(evenly(-15, 15, 3), evenly(-12, 12, 3), evenly(0, 12, 2));
  body.materials = {{.shear_modulus = 0.03, .bulk_modulus = 0.3}};
  const ContactSystem system(body, {.tip_radius = kRadius});
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(-1, 1);
  const auto anywhere = [&] { return Vector3d{part(random), part(random), part(random)}; };
  std::size_t touched = 0;
  for (int turn = 0; turn < 200; ++turn) {
    // Its nodes move by up to 0.7 mm, so faces are curved.
    ContactState start;
    start.positions = body.mesh.nodes;
    for (auto node : start.positions.colwise()) node += 0.7 * anywhere();
    const Vector3d tip = anywhere().cwiseProduct(Vector3d(20, 17, 12)) + Vector3d(0, 0, 6);
    start.tip = tip;
    std::vector<std::pair<int, int>> within, found;
    for (std::size_t f = 0; f < system.faces().size(); ++f) {
      const ContactFace& face = system.faces()[f];
      Eigen::Matrix<double, 3, 6> nodes;
      for (int k = 0; k < 6; ++k) nodes.col(k) = start.positions.col(face.face.nodes[k]);
      const Eigen::Matrix3Xd points = nodes * face.rule->shapes;
      for (Eigen::Index p = 0; p < points.cols(); ++p)
        if ((points.col(p) - tip).norm() < kRadius)
          within.emplace_back(static_cast<int>(f), static_cast<int>(p));
    }
    const SystemForces forces = system.forces(start.positions, tip, &start);
    ASSERT_TRUE(forces.valid);
    for (const FaceContact& contact : forces.contacts)
      found.emplace_back(contact.face, contact.point);
    EXPECT_EQ(found, within) << "tip at " << tip.transpose();
    touched += within.size();
  }
  EXPECT_GT(touched, 10000U);
}

TEST(ContactSystem, TheTipActsOnAFaceWithANodeAtItsCentre) {
  DeformableBody body;
  body.mesh = box_mesh(evenly(-15, 15, 3), evenly(-12, 12, 3), evenly(0, 12, 2));
  body.materials = {{.shear_modulus = 0.03, .bulk_modulus = 0.3}};
  const ContactSystem system(body, {.tip_radius = 4});
  ContactState start;
  start.positions = body.mesh.nodes;
  for (int k = 0; k < 6; ++k) {
    const int node = system.faces().front().face.nodes[k];
    start.tip = body.mesh.nodes.col(node);
    const SystemForces forces = system.forces(start.positions, start.tip, &start);
    EXPECT_TRUE(std::ranges::any_of(forces.contacts,
                                    [](const FaceContact& contact) { return contact.face == 0; }))
        << "node " << node;
  }
}

}  // namespace
}  // namespace palpate::probing
