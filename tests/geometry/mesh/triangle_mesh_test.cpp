// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/triangle_mesh.h"

#include <gmock/gmock.h>

#include <array>
#include <limits>
#include <string>

#include "not_finite.h"
#include "palpate/core/error.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using ::testing::HasSubstr;

/// About twenty double operations on values of the order of one.
constexpr double kPositionRounding = 1e-14;

TriangleMesh one_triangle() {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices << 0, 2, 0,  //
      0, 0, 3,               //
      0, 0, 0;
  mesh.triangles.resize(3, 1);
  mesh.triangles << 0, 1, 2;
  return mesh;
}

std::string refused_mesh(const TriangleMesh& mesh) {
  return refusal([&] { check_mesh(mesh, "the target"); });
}

TEST(CheckMesh, AcceptsAMeshWithAnUnusedVertexAndOneWithoutArea) {
  TriangleMesh mesh = one_triangle();
  mesh.vertices.conservativeResize(3, 4);
  mesh.vertices.col(3).setOnes();
  EXPECT_NO_THROW(check_mesh(mesh, "the target"));
  mesh.vertices.setZero();
  EXPECT_NO_THROW(check_mesh(mesh, "the target"));
}

TEST(CheckMesh, RefusesAMeshWithoutTriangles) {
  EXPECT_EQ(refused_mesh(TriangleMesh{}),
            "the target: the mesh has no triangles; at least one is needed");
}

TEST(CheckMesh, NamesTheFirstVertexThatIsNotFinite) {
  for (const double bad : {kNaN, std::numeric_limits<double>::infinity()}) {
    TriangleMesh mesh = one_triangle();
    mesh.vertices(2, 1) = bad;
    EXPECT_EQ(refused_mesh(mesh),
              "the target: vertex 1 is not finite; remove it and its triangles");
  }
}

TEST(CheckMesh, NamesTheTriangleWhoseIndexIsOutOfRange) {
  for (const int bad : {-1, 3}) {
    TriangleMesh mesh = test::flat_sheet(1, 1, 1);
    mesh.vertices.conservativeResize(3, 3);
    mesh.triangles.col(0) << 0, 1, 2;
    mesh.triangles.col(1) << 0, bad, 2;
    EXPECT_EQ(refused_mesh(mesh), "the target: triangle 1 names vertex " + std::to_string(bad) +
                                      "; the mesh has vertices 0 to 2");
  }
}

TEST(CheckMesh, NamesTheTriangleThatUsesAVertexTwice) {
  TriangleMesh mesh = one_triangle();
  mesh.triangles.col(0) << 0, 2, 2;
  EXPECT_EQ(
      refused_mesh(mesh),
      "the target: triangle 0 names a vertex twice (0, 2, 2); its three vertices must differ");
}

TEST(CheckSurfacePoint, RefusesWhatIsNotAPlaceOnTheMesh) {
  const TriangleMesh mesh = one_triangle();
  EXPECT_NO_THROW(check_surface_point(mesh, {0, {0.333333, 0.333333, 0.333333}}, "contact"));
  EXPECT_THROW(check_surface_point(mesh, {1, {1, 0, 0}}, "contact"), InvalidInput);
  EXPECT_THROW(check_surface_point(mesh, {-1, {1, 0, 0}}, "contact"), InvalidInput);
  EXPECT_THROW(check_surface_point(mesh, {0, {1.1, -0.1, 0}}, "contact"), InvalidInput);
  EXPECT_THROW(check_surface_point(mesh, {0, {0.5, 0.4, 0}}, "contact"), InvalidInput);
  EXPECT_THROW(check_surface_point(mesh, {0, {kNaN, 0.5, 0.5}}, "contact"), InvalidInput);
}

TEST(Position, WeighsTheCorners) {
  const Eigen::Vector3d p = position(one_triangle(), {0, {0.5, 0.2, 0.3}});
  EXPECT_LT((p - Eigen::Vector3d(0.4, 0.9, 0)).norm(), kPositionRounding);
}

TEST(VertexPoints, LieOnTheirVertices) {
  TriangleMesh mesh = test::icosphere(1, 1.7);
  mesh.vertices.conservativeResize(3, mesh.vertices.cols() + 1);
  mesh.vertices.rightCols<1>() << 9, 9, 9;  // in no triangle
  const std::vector<SurfacePoint> points = vertex_points(mesh);
  ASSERT_EQ(static_cast<Eigen::Index>(points.size()), mesh.vertices.cols());
  for (std::size_t v = 0; v + 1 < points.size(); ++v) {
    EXPECT_NO_THROW(check_surface_point(mesh, points[v], "vertex"));
    EXPECT_LT((position(mesh, points[v]) - mesh.vertices.col(static_cast<int>(v))).norm(),
              kPositionRounding);
    EXPECT_EQ(points[v].barycentric.maxCoeff(), 1);
  }
  EXPECT_EQ(points.back().triangle, -1);

  const std::vector<SurfacePoint> some = vertex_points(mesh, std::array{7, 0});
  ASSERT_EQ(some.size(), 2U);
  EXPECT_EQ(some[0].triangle, points[7].triangle);
  EXPECT_EQ(some[0].barycentric, points[7].barycentric);
  EXPECT_EQ(some[1].triangle, points[0].triangle);
  const auto last = static_cast<int>(points.size()) - 1;
  for (const int wrong : {-1, last, last + 1})
    EXPECT_THAT(refusal([&] {
                  return vertex_points(mesh, std::array{3, wrong}, "sources");
                }),
                HasSubstr("sources[1] is " + std::to_string(wrong)));
}

TEST(TriangleNormals, PointToTheSideFromWhichTheCornersRunCounterClockwise) {
  EXPECT_EQ(triangle_normals(one_triangle()).col(0), Eigen::Vector3d::UnitZ());
}

TEST(TriangleNormals, DoNotDependOnTheUnitOfLength) {
  const TriangleMesh sphere = test::icosphere(1, 1.7);
  const Eigen::Matrix3Xd expected = triangle_normals(sphere);
  for (const double factor : {0x1p-600, 0x1p-20, 0x1p20, 0x1p600}) {
    EXPECT_EQ(triangle_normals(test::scaled(sphere, factor)), expected) << factor;
  }
}

TEST(TriangleNormals, AreNanWithoutArea) {
  TriangleMesh line = one_triangle();
  line.vertices.col(1) << 0.1, 0.7, 0.3;
  line.vertices.col(2) = 3 * line.vertices.col(1);
  EXPECT_TRUE(triangle_normals(line).array().isNaN().all());
  line.vertices.setConstant(0.7);
  EXPECT_TRUE(triangle_normals(line).array().isNaN().all());
}

TEST(VertexNormals, OfASphereApproachItsRadii) {
  // Linear convergence; the first two levels are exact by symmetry.
  double last_error = 0.02;
  for (const int levels : {2, 3, 4, 5}) {
    const TriangleMesh sphere = test::icosphere(levels, 2.5);
    const double error =
        (vertex_normals(sphere) - sphere.vertices / 2.5).colwise().norm().maxCoeff();
    EXPECT_LT(error, 0.6 * last_error);
    last_error = error;
  }
}

TEST(VertexNormals, OfACubeCornerAreItsDiagonalHoweverItsFacesAreCut) {
  // Three faces of a cube; one is cut through the corner, so that two of four triangles are of one
  // face.
  TriangleMesh mesh;
  mesh.vertices.resize(3, 7);
  mesh.vertices << 0, 1, 0, 0, 1, 1, 0,  //
      0, 0, 1, 0, 1, 0, 1,               //
      0, 0, 0, 1, 0, 1, 1;
  mesh.triangles.resize(3, 4);
  mesh.triangles << 0, 0, 0, 0,  //
      4, 2, 3, 1,                //
      1, 4, 2, 3;
  const Eigen::Vector3d diagonal = -Eigen::Vector3d::Ones().normalized();
  EXPECT_LT((vertex_normals(mesh).col(0) - diagonal).norm(), kPositionRounding);
}

TEST(VertexNormals, IgnoreTrianglesWithoutAreaAndAreNanWithoutAnyTriangle) {
  TriangleMesh mesh = one_triangle();
  mesh.vertices.conservativeResize(3, 5);
  mesh.vertices.col(3) << 4, 0, 0;
  mesh.vertices.col(4) << 5, 5, 5;
  mesh.triangles.conservativeResize(3, 2);
  mesh.triangles.col(1) << 0, 1, 3;
  const Eigen::Matrix3Xd normals = vertex_normals(mesh);
  EXPECT_EQ(normals.col(0), Eigen::Vector3d::UnitZ());
  EXPECT_TRUE(normals.col(3).array().isNaN().all());
  EXPECT_TRUE(normals.col(4).array().isNaN().all());
}

TEST(BoundingDiagonal, IsThatOfTheBox) {
  EXPECT_DOUBLE_EQ(bounding_diagonal(one_triangle()), std::sqrt(13.0));
  EXPECT_EQ(bounding_diagonal(TriangleMesh{}), 0);
}

}  // namespace
}  // namespace palpate::geometry
