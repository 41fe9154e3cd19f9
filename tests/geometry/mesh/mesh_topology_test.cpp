// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_topology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "mesh_corpus.h"
#include "palpate/core/error.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

/// Edges at the border and inside, if opposite half-edges name each other and the same vertices.
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

/// Both meshes as one, not joined.
TriangleMesh beside(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh both;
  both.vertices.resize(3, a.vertices.cols() + b.vertices.cols());
  both.vertices << a.vertices, b.vertices;
  both.triangles.resize(3, a.triangles.cols() + b.triangles.cols());
  both.triangles << a.triangles,
      (b.triangles.array() + static_cast<int>(a.vertices.cols())).matrix();
  return both;
}

/// Two triangles that share one vertex.
TriangleMesh bow_tie() {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 5);
  mesh.vertices << 0, -1, -1, 1, 1, 0, 1, -1, -1, 1, 0, 0, 0, 0, 0;
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 0, 1, 3, 2, 4;
  return mesh;
}

TEST(MeshTopology, EulersFormulaHoldsOnClosedSurfaces) {
  const auto check = [](const TriangleMesh& mesh, int expected) {
    EXPECT_EQ(count_edges(mesh)[0], 0);
    EXPECT_EQ(euler_characteristic(mesh), expected);
    EXPECT_TRUE(boundary_loops(mesh).empty());
    EXPECT_EQ(connected_components(mesh).count, 1);
  };
  check(test::icosphere(3, 10), 2);
  check(test::glove(), 2);
  check(test::closed_sheet(), 2);
  check(test::torus(40, 9, 30, 5), 0);
}

TEST(MeshTopology, AVertexMayHaveAnyNumberOfTriangles) {
  // A disk of triangles round its centre, which is the first vertex or the last one: a search
  // through all of them for each would take longer than a test may.
  constexpr int kCount = 50000;
  for (const bool centre_first : {true, false}) {
    const int centre = centre_first ? 0 : kCount;
    const auto rim = [&](int i) { return i % kCount + (centre_first ? 1 : 0); };
    TriangleMesh disk;
    disk.vertices = Eigen::Matrix3Xd::Zero(3, kCount + 1);
    disk.triangles.resize(3, kCount);
    for (int i = 0; i < kCount; ++i) {
      const double angle = 2 * std::numbers::pi * i / kCount;
      disk.vertices.col(rim(i)) << std::cos(angle), std::sin(angle), 0;
      disk.triangles.col(i) << rim(i), rim(i + 1), centre;
    }
    EXPECT_EQ(count_edges(disk), Eigen::Vector2i(kCount, kCount));
    EXPECT_EQ(boundary_loops(disk).size(), 1u);
  }
}

TEST(MeshTopology, ASheetWithTwoHolesHasThreeLoops) {
  const TriangleMesh mesh = test::bumpy(5000);
  const auto loops = boundary_loops(mesh);
  ASSERT_EQ(loops.size(), 3u);
  EXPECT_EQ(euler_characteristic(mesh), 2 - 3);
  std::size_t length = 0;
  for (const auto& loop : loops) {
    length += loop.size();
    EXPECT_EQ(loop.front(), *std::min_element(loop.begin(), loop.end()));
    // Twice the area that it goes around, seen along the optical axis, from the camera's side.
    double turn = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Eigen::Vector3d a = mesh.vertices.col(loop[i]);
      const Eigen::Vector3d b = mesh.vertices.col(loop[(i + 1) % loop.size()]);
      turn += a.y() / a.z() * b.x() / b.z() - a.x() / a.z() * b.y() / b.z();
    }
    EXPECT_EQ(turn > 0, &loop == &loops.front());  // the outline starts at vertex 0
  }
  EXPECT_EQ(static_cast<int>(length), count_edges(mesh)[0]);
}

TEST(MeshTopology, ALoopRunsWithTheSurfaceOnItsLeftFromItsSmallestVertex) {
  TriangleMesh mesh = test::flat_sheet(2, 1, 1.5);
  const std::vector<std::vector<int>> outline = {{0, 1, 2, 5, 4, 3}};
  EXPECT_EQ(boundary_loops(mesh), outline);
  mesh.triangles.rowwise().reverseInPlace();  // the order of triangles means nothing
  EXPECT_EQ(boundary_loops(mesh), outline);
}

TEST(MeshTopology, PartsThatTouchInAVertexAreTwo) {
  const std::vector<std::vector<int>> loops = {{0, 1, 2}, {0, 3, 4}};
  EXPECT_EQ(boundary_loops(bow_tie()), loops);
  EXPECT_EQ(connected_components(bow_tie()).component, Eigen::Vector2i(0, 1));
}

TEST(MeshTopology, ComponentsAreNumberedByTheirFirstTriangle) {
  const TriangleMesh mesh = beside(test::icosphere(1, 10), test::flat_sheet(3, 2, 1.5));
  const ConnectedComponents components = connected_components(mesh);
  EXPECT_EQ(components.count, 2);
  EXPECT_EQ(components.component.head(80), Eigen::VectorXi::Zero(80));
  EXPECT_EQ(components.component.tail(12), Eigen::VectorXi::Ones(12));
  EXPECT_EQ(euler_characteristic(mesh), 2 + 1);
}

TEST(MeshTopology, AVertexWithoutTriangleDoesNotCount) {
  TriangleMesh mesh = test::icosphere(1, 10);
  mesh.vertices.conservativeResize(3, mesh.vertices.cols() + 1);
  mesh.vertices.rightCols<1>().setZero();
  EXPECT_EQ(euler_characteristic(mesh), 2);
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
