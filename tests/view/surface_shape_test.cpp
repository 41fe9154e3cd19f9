// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surface_shape.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "test_surfaces.h"

namespace palpate::view {
namespace {

using geometry::SurfacePoint;
using geometry::TriangleMesh;

/// [mm] of coordinates up to 100 mm in single precision, with some operations.
constexpr float kFloatRounding = 1e-4F;

TriangleMesh wavy() {
  return geometry::test::height_field(
      40, 30, 2, [](double x, double y) { return 3 * std::sin(x / 7) * std::cos(y / 5); });
}

/// Means of the triangles' normals weighted by area, of all triangles.
Eigen::Matrix3Xf normals_of(const TriangleMesh& mesh, const Eigen::Matrix3Xf& positions) {
  Eigen::Matrix3Xf normals = Eigen::Matrix3Xf::Zero(3, positions.cols());
  for (const auto corners : mesh.triangles.colwise()) {
    const Eigen::Vector3f a = positions.col(corners[0]);
    const Eigen::Vector3f normal =
        (positions.col(corners[1]) - a).cross(positions.col(corners[2]) - a);
    for (const int v : corners) normals.col(v) += normal;
  }
  return normals.colwise().normalized();
}

void expect_same(const SurfaceShape& shape, const Eigen::Matrix3Xd& whole) {
  EXPECT_LT((shape.positions() - whole.cast<float>()).cwiseAbs().maxCoeff(), kFloatRounding);
  EXPECT_LT(
      (shape.normals() - normals_of(shape.surface(), shape.positions())).cwiseAbs().maxCoeff(),
      kFloatRounding);
  EXPECT_LT((shape.moved().cast<double>() -
             (whole - shape.surface().vertices).colwise().norm().transpose())
                .cwiseAbs()
                .maxCoeff(),
            static_cast<double>(kFloatRounding));
}

TEST(SurfaceShape, IsTheShapeThatTheLibraryDraws) {
  const TriangleMesh mesh = wavy();
  SurfaceShape shape(mesh);
  expect_same(shape, mesh.vertices);
  const haptics::DrawnShapeOptions options{.tip = 2, .reach = 2.5};
  // One dent after the other: in the middle, at the border, a deep one, and one that is small.
  for (const auto& [triangle, depth] :
       {std::pair(1200, 4.0), std::pair(0, 3.0), std::pair(1500, 20.0), std::pair(800, 0.5)}) {
    const SurfacePoint at{triangle, {0.2, 0.5, 0.3}};
    const Eigen::Vector3d displacement(0.3 * depth, -0.2 * depth, -depth);
    shape.deform(at, displacement, options);
    expect_same(shape, haptics::drawn_shape(mesh, at, displacement, options));
  }
  shape.rest();
  expect_same(shape, mesh.vertices);
}

TEST(SurfaceShape, TellsWhichVerticesChanged) {
  const TriangleMesh mesh = wavy();
  SurfaceShape shape(mesh);
  Eigen::Matrix3Xf shown = shape.positions(), shown_normals = shape.normals();
  const auto expect_told = [&](const VertexRange& range) {
    const Eigen::Index count = range.end - range.begin;
    shown.middleCols(range.begin, count) = shape.positions().middleCols(range.begin, count);
    shown_normals.middleCols(range.begin, count) = shape.normals().middleCols(range.begin, count);
    EXPECT_EQ(shown, shape.positions());
    EXPECT_EQ(shown_normals, shape.normals());
  };
  const VertexRange first = shape.deform({100, {1, 0, 0}}, {0, 0, -1}, {.tip = 1, .reach = 2});
  EXPECT_LT(first.end - first.begin, mesh.vertices.cols() / 2) << "not all of it";
  expect_told(first);
  expect_told(shape.deform({2200, {0, 1, 0}}, {0, 0, -3}, {.tip = 1, .reach = 2}));
  expect_told(shape.rest());
}

TEST(SurfaceShape, MovesATriangleThatIsLargerThanTheDent) {
  const TriangleMesh mesh = geometry::test::flat_sheet(2, 2, 50);
  SurfaceShape shape(mesh);
  const SurfacePoint corner{0, {1, 0, 0}};
  shape.deform(corner, {0, 0, -2}, {});
  expect_same(shape, haptics::drawn_shape(mesh, corner, {0, 0, -2}));
}

TEST(SurfaceShape, IsAnyShapeOfTheWholeSurface) {
  const TriangleMesh mesh = wavy();
  SurfaceShape shape(mesh);
  const Eigen::Matrix3Xd turned =
      Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix() *
      mesh.vertices;
  const VertexRange range = shape.show(turned);
  EXPECT_EQ(range.end - range.begin, mesh.vertices.cols());
  expect_same(shape, turned);
  // A dent begins from rest again.
  const SurfacePoint at{1200, {0.2, 0.5, 0.3}};
  shape.deform(at, {0, 0, -3}, {});
  expect_same(shape, haptics::drawn_shape(mesh, at, {0, 0, -3}, {}));
  shape.show(turned);
  shape.rest();
  expect_same(shape, mesh.vertices);
}

}  // namespace
}  // namespace palpate::view
