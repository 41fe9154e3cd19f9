// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/contact_subset.h"

#include <gtest/gtest.h>

#include "palpate/haptics/blended_field.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

Model plate(double spacing) {
  return grid_model(spacing,
                    [](double x, double y) { return spring(4 + 0.03 * x - 0.02 * y, 10); });
}

TEST(WithContacts, GivesWhatTheModelOfFewerContactsGives) {
  const Model all = plate(21), some = plate(42);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < all.contacts.size(); ++i) {
    for (const ContactModel& contact : some.contacts)
      if (contact.position == all.contacts[i].position) kept.push_back(i);
  }
  ASSERT_EQ(kept.size(), some.contacts.size());
  const Model thinned = with_contacts(all, kept);
  EXPECT_EQ(thinned.triangles, some.triangles);
  for (const Vector3d& place : {Vector3d(3, 5, 700), Vector3d(-40, 17, 700), Vector3d(0, -49, 700)})
    EXPECT_LT((BlendedField(thinned).force(place, kDisplacement) -
               BlendedField(some).force(place, kDisplacement))
                  .norm(),
              1e-12);
}

TEST(OnSurface, KeepsForcesAtTheVerticesOfACoarserSurface) {
  Model model = plate(21);
  const geometry::TriangleMesh coarse = flat_surface(50, 5);
  const Model moved = on_surface(model, coarse);
  EXPECT_NO_THROW(check_model(moved));
  EXPECT_LT(moved.surface.vertices.cols(), model.surface.vertices.cols() * 2);
  for (const auto& vertex : coarse.vertices.colwise())
    EXPECT_LT((BlendedField(moved).force(vertex, kDisplacement) -
               BlendedField(model).force(vertex, kDisplacement))
                  .norm(),
              1e-9);
}

// Four contacts weigh the same at the centre of a square of them.
TEST(OnSurface, HasAForceWhereFourContactsWeighTheSame) {
  Model model = plate(42);
  model.surface = flat_surface(50, 2);
  model.surface_weights = {Eigen::Matrix3Xi::Constant(3, 9, -1), Eigen::Matrix3Xd::Zero(3, 9)};
  const auto give = [&](Eigen::Index vertex, int a, int b) {
    model.surface_weights.contacts.col(vertex) << a, b, -1;
    model.surface_weights.weights.col(vertex) << 0.5, 0.5, 0;
  };
  for (Eigen::Index v = 0; v < 9; ++v) give(v, 0, 1);
  give(1, 0, 1);  // opposite sides of the square
  give(3, 2, 3);
  const Model moved = on_surface(model, flat_surface(50, 4));
  for (Eigen::Index v = 0; v < moved.surface.vertices.cols(); ++v)
    EXPECT_NEAR(moved.surface_weights.weights.col(v).sum(), 1, 1e-12);
}

TEST(OnSurface, MovesContactsOntoTheSurface) {
  Model model = plate(42);
  geometry::TriangleMesh raised = model.surface;
  raised.vertices.row(2).array() += 0.1;
  for (const ContactModel& contact : on_surface(model, raised).contacts)
    EXPECT_NEAR(contact.position.z(), 700.1, 1e-9);
}

}  // namespace
}  // namespace palpate::haptics
