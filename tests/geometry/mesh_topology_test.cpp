// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_topology.h"

#include <gtest/gtest.h>

#include <string>

#include "mesh_corpus.h"
#include "palpate/error.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

/// Edges at the border and inside, when opposite half-edges name each other and the same vertices.
Eigen::Vector2i count_edges(const TriangleMesh& mesh) {
  const Eigen::Matrix3Xi opposite = opposite_half_edges(mesh);
  Eigen::Vector2i border_and_inner = Eigen::Vector2i::Zero();
  for (int h = 0; h < opposite.size(); ++h) {
    const int other = opposite(h % 3, h / 3);
    if (other < 0) {
      ++border_and_inner[0];
      continue;
    }
    EXPECT_EQ(opposite(other % 3, other / 3), h);
    EXPECT_EQ(mesh.triangles(h % 3, h / 3), mesh.triangles((other + 1) % 3, other / 3));
    EXPECT_EQ(mesh.triangles((h + 1) % 3, h / 3), mesh.triangles(other % 3, other / 3));
    if (h < other) ++border_and_inner[1];
  }
  return border_and_inner;
}

TEST(MeshTopology, EulersFormulaHoldsOnClosedSurfaces) {
  const auto euler_characteristic = [](const TriangleMesh& mesh) {
    const Eigen::Vector2i edges = count_edges(mesh);
    EXPECT_EQ(edges[0], 0);
    return mesh.vertices.cols() - edges[1] + mesh.triangles.cols();
  };
  EXPECT_EQ(euler_characteristic(test::icosphere(3, 10)), 2);
  EXPECT_EQ(euler_characteristic(test::glove()), 2);
  EXPECT_EQ(euler_characteristic(test::closed_sheet()), 2);
  EXPECT_EQ(euler_characteristic(test::torus(40, 9, 30, 5)), 0);
}

TEST(MeshTopology, ASheetHasItsOutlineAsBorder) {
  EXPECT_EQ(count_edges(test::flat_sheet(7, 4, 1.5))[0], 2 * (7 + 4));
}

TEST(MeshTopology, NamesTheEdgeOfATriangleThatIsTurnedOver) {
  TriangleMesh mesh = test::flat_sheet(1, 1, 1);
  mesh.triangles.col(1).reverseInPlace();
  try {
    (void)opposite_half_edges(mesh);
    FAIL() << "accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("triangles 0 and 1"), std::string::npos)
        << error.what();
  }
}

TEST(MeshTopology, RefusesAnEdgeOfThreeTriangles) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 5);
  mesh.vertices << 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0, 1, 1;
  mesh.triangles.resize(3, 3);
  mesh.triangles << 0, 1, 0, 1, 0, 1, 2, 3, 4;
  EXPECT_THROW((void)opposite_half_edges(mesh), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
