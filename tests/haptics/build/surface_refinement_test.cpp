// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/surface_refinement.h"

#include <gtest/gtest.h>

#include <random>

#include "palpate/geometry/contact_locator.h"
#include "palpate/geometry/surface_query.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

// 7 x 7 contacts in the middle of a flat square, which has 2 cells^2 triangles.
Model coarse_grid_model(double spacing, double half_size, int cells) {
  Model model;
  model.surface = flat_surface(half_size, cells);
  model.contacts.resize(49);
  for (int i = 0; i < 49; ++i)
    model.contacts[static_cast<std::size_t>(i)].position << spacing * (i % 7 - 3),
        spacing * (i / 7 - 3), 700;
  return model;
}

std::vector<geometry::SurfacePoint> refine(Model& model) {
  const auto count = static_cast<Eigen::Index>(model.contacts.size());
  return refine_surface(Vector3d::UnitZ().replicate(1, count), model).places;
}

// Piecewise linear interpolation of |x|^2 in Delaunay triangles errs by at most the square of their
// circumradius, that within the triangles of the surface by a quarter of the square of their edges.
TEST(RefineSurface, LetsWeightsFollowTheContactsOnASurfaceOfTwoTriangles) {
  constexpr double kSpacing = 14;
  Model model = coarse_grid_model(kSpacing, 60, 1);
  const std::vector<geometry::SurfacePoint> places = refine(model);
  const geometry::ContactLocator locator(
      model.surface, places, geometry::triangulate_contacts(model.surface, places).weights);
  const geometry::SurfaceQuery query(model.surface);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> inside(-3 * kSpacing, 3 * kSpacing);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d at{inside(random), inside(random), 700};
    const geometry::ContactWeights found = locator.locate(query.closest_point(at).at);
    double sum = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(found.count); ++k) {
      const auto contact = static_cast<std::size_t>(found.contacts[k]);
      sum += found.weights[k] * model.contacts[contact].position.squaredNorm();
    }
    EXPECT_NEAR(sum, at.squaredNorm(), kSpacing * kSpacing);
  }
}

TEST(RefineSurface, LeavesTrianglesLargeFarFromContacts) {
  Model model = coarse_grid_model(1, 1000, 1);
  refine(model);
  int near = 0, far = 0;
  for (const auto& vertex : model.surface.vertices.colwise())
    (vertex.head<2>().norm() < 6 ? near : far) += 1;
  EXPECT_GT(near, 200);
  EXPECT_LT(far, 2000);
}

TEST(RefineSurface, LeavesASurfaceOfSmallTrianglesAsItIs) {
  Model model = coarse_grid_model(14, 60, 30);
  const geometry::TriangleMesh given = model.surface;
  refine(model);
  EXPECT_EQ(model.surface.vertices, given.vertices);
  EXPECT_EQ(model.surface.triangles, given.triangles);
}

// The other side of a plate is near, but its contacts are others.
TEST(RefineSurface, LooksAtContactsOnTheSameSideOfTheObject) {
  Model model = coarse_grid_model(14, 60, 12);
  Eigen::Matrix3Xd directions = Vector3d::UnitZ().replicate(1, 98);
  for (int i = 0; i < 49; ++i) {
    ContactModel& contact =
        model.contacts.emplace_back(model.contacts[static_cast<std::size_t>(i)]);
    contact.position.z() += 1;
    directions.col(49 + i) *= -1;
  }
  refine_surface(directions, model);
  EXPECT_LT(model.surface.vertices.cols(), 4 * 13 * 13);
}

}  // namespace
}  // namespace palpate::haptics
