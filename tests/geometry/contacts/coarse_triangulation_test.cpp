// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "contacts/contact_testing.h"
#include "mesh_corpus.h"
#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/mesh_topology.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

TEST(CoarseTriangulation, ContactsNextToAVertexNeedNoMoreHelpersThanContactsAtIt) {
  const TriangleMesh sheet = test::height_field(
      40, 40, 1.3, [](double x, double y) { return 3 * std::sin(x / 20) * std::cos(y / 17); });
  const auto triangulate = [&](double offset) {
    std::vector<SurfacePoint> contacts;
    for (int row = 4; row <= 36; row += 8) {
      for (int col = 4; col <= 36; col += 8) {
        // The first corner of this square's first triangle.
        contacts.push_back(
            {.triangle = 2 * (row * 40 + col), .barycentric = {1 - 2 * offset, offset, offset}});
      }
    }
    return triangulate_contacts(sheet, contacts);
  };
  const auto at_vertices = triangulate(0);
  for (const double offset : {1e-9, 1e-7, 1e-6, 1e-5, 9e-5}) {
    EXPECT_EQ(triangulate(offset).intrinsic.helpers.cols(), at_vertices.intrinsic.helpers.cols())
        << offset;
    EXPECT_EQ(triangulate(offset).mesh.triangles, at_vertices.mesh.triangles) << offset;
  }
}

TEST(CoarseTriangulation, OfManyContactsOnARangeMapHasItsHolesAndNoOther) {
  for (const double noise : {0.0, 0.25}) {
    const TriangleMesh surface = test::bumpy(8000, noise);
    for (const unsigned seed : {1U, 2U, 3U, 4U}) {
      const ContactTriangulation result =
          triangulate_contacts(surface, test::random_contacts(surface, 300, seed));
      EXPECT_EQ(test::check_manifold(result.mesh).euler(), euler_characteristic(surface)) << seed;
      EXPECT_EQ(boundary_loops(result.mesh).size(), boundary_loops(surface).size()) << seed;
    }
  }
}

}  // namespace
}  // namespace palpate::geometry
