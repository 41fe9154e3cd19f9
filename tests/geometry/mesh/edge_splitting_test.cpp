// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/edge_splitting.h"

#include <gtest/gtest.h>

#include "palpate/core/error.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/surface_query.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

auto longer_than(double length) {
  return [length](const Vector3d& a, const Vector3d& b) { return (b - a).norm() > length; };
}

// A closed surface of 20 mm x 90 mm x 3 mm: long edges and thin triangles.
TriangleMesh flake() {
  TriangleMesh mesh = test::icosphere(0, 1);
  mesh.vertices = Vector3d(10, 45, 1.5).asDiagonal() * mesh.vertices;
  return mesh;
}

TEST(SplitEdges, LeavesNoLongEdgeAndKeepsTheSurface) {
  const TriangleMesh given = flake();
  for (const double length : {50.0, 7.0, 2.5}) {
    const SplitMesh split = split_edges(given, longer_than(length));
    EXPECT_LE(mesh_shape(split.mesh).longest_edge, length);
    EXPECT_EQ(split.mesh.vertices.leftCols(given.vertices.cols()), given.vertices);
    EXPECT_NEAR(surface_area(split.mesh) / surface_area(given), 1, 1e-12);
    EXPECT_NEAR(enclosed_volume(split.mesh) / enclosed_volume(given), 1, 1e-12);
    const SurfaceQuery query(given);
    for (const auto& vertex : split.mesh.vertices.colwise())
      EXPECT_LT(query.closest_point(vertex).distance, 1e-12);
  }
}

TEST(SplitEdges, ReturnsAMeshWithoutLongEdgesAsItIs) {
  const TriangleMesh given = flake();
  const SplitMesh split = split_edges(given, longer_than(1000));
  EXPECT_EQ(split.mesh.vertices, given.vertices);
  EXPECT_EQ(split.mesh.triangles, given.triangles);
  EXPECT_EQ(split.ends.cols(), 0);
}

TEST(SplitEdges, SplitsWhereItIsAskedFor) {
  const auto near_origin = [](const Vector3d& a, const Vector3d& b) {
    return (b - a).norm() > std::max(1.0, (a + b).norm() / 2);
  };
  const SplitMesh split = split_edges(flake(), near_origin);
  int near = 0, far = 0;
  for (const auto& vertex : split.mesh.vertices.colwise()) (vertex.norm() < 10 ? near : far) += 1;
  EXPECT_GT(near, 50);
  EXPECT_LT(far, near);
}

TEST(SplitEdges, ContinuesOtherPositionsOfTheVertices) {
  const TriangleMesh given = flake();
  const SplitMesh split = split_edges(given, longer_than(7));
  ASSERT_GT(split.ends.cols(), 0);
  EXPECT_EQ(with_middles(given.vertices, split.ends), split.mesh.vertices);
  Eigen::Matrix3d linear;
  linear << 1, 2, 3, 0, -1, 4, 2, 0, 5;
  EXPECT_TRUE(with_middles(linear * given.vertices, split.ends)
                  .isApprox(linear * split.mesh.vertices, 1e-14));
}

TEST(SplitEdges, EndsWhereMiddlesCannotBeTold) {
  TriangleMesh tiny = flake();
  tiny.vertices = (1e-14 * tiny.vertices).array() + 1e3;
  const SplitMesh split = split_edges(tiny, longer_than(0));
  EXPECT_LT(split.mesh.triangles.cols(), 1000);
  EXPECT_THROW(static_cast<void>(split_edges({}, longer_than(1))), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
