// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>
#include <vector>

#include "file_testing.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {
namespace {

using Outline = std::vector<Eigen::Vector2d>;

/// Reads back one polygon drawn on a tilted plane.
TriangleMesh triangulated(const Outline& outline) {
  std::ostringstream vertices;
  std::ostringstream face;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d& p = outline[i];
    vertices << "v " << p.x() << " " << p.y() << " " << 0.5 * p.x() - p.y() << "\n";
    face << " " << i + 1;
  }
  const ScratchFolder folder;
  write_text(folder / "mesh.obj", vertices.str() + "f" + face.str() + "\n");
  return read_mesh(folder / "mesh.obj");
}

/// Area of an outline, by the shoelace formula.
double area(const Outline& outline) {
  double sum = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d& p = outline[i];
    const Eigen::Vector2d& q = outline[(i + 1) % outline.size()];
    sum += (p.x() * q.y() - p.y() * q.x()) / 2;
  }
  return sum;
}

/// The triangles cover the outline once: their areas are all of its sign and sum up to its own.
void expect_covers(const Outline& outline) {
  const TriangleMesh mesh = triangulated(outline);
  EXPECT_EQ(mesh.triangles.cols(), static_cast<Eigen::Index>(outline.size()) - 2);
  double sum = 0;
  for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i) {
    Outline triangle;
    for (const int corner : mesh.triangles.col(i))
      triangle.emplace_back(mesh.vertices.col(corner).head<2>());
    const double part = area(triangle);
    EXPECT_GE(part * area(outline), 0);
    sum += part;
  }
  EXPECT_NEAR(sum, area(outline), 1e-5 * std::abs(area(outline)));  // the text has 6 digits
}

TEST(PolygonMesh, ConvexPolygonsAreCovered) {
  Outline circle;
  for (int i = 0; i < 40; ++i) {
    const double angle = 2 * std::numbers::pi * i / 40;
    circle.emplace_back(10 * std::cos(angle), 10 * std::sin(angle));
  }
  expect_covers(circle);
  expect_covers({{0, 0}, {2, 0}, {2, 1}, {0, 1}});
}

TEST(PolygonMesh, ConcavePolygonsKeepTheirOutline) {
  // From its first corner, none of these can be cut into a fan.
  expect_covers({{0, 0}, {4, 0}, {4, 4}, {2, 1}});
  expect_covers({{2, 1}, {0, 0}, {4, 0}, {4, 4}});
  expect_covers({{0, 0}, {6, 0}, {6, 4}, {4, 4}, {4, 1}, {2, 1}, {2, 4}, {0, 4}});
  Outline star;
  for (int i = 0; i < 22; ++i) {
    const double angle = 2 * std::numbers::pi * i / 22;
    star.emplace_back((i % 2 == 0 ? 10 : 3) * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  expect_covers(star);
}

TEST(PolygonMesh, ManyCornersOfWhichFewAreEarsAreCutAsWell) {
  Outline zigzag;
  constexpr int kTeeth = 500;
  for (int i = 0; i < kTeeth; ++i) zigzag.emplace_back(i, i % 2 == 0 ? 1 : 10);
  for (int i = kTeeth; i-- > 0;) zigzag.emplace_back(i, i % 2 == 0 ? 0 : 9);
  expect_covers(zigzag);
}

TEST(PolygonMesh, ClockwisePolygonsStayClockwise) {
  expect_covers({{0, 0}, {0, 4}, {6, 4}, {6, 0}, {3, 2}});
}

TEST(PolygonMesh, StraightCornersAreKept) {
  expect_covers({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {0, 1}});
}

TEST(PolygonMesh, APolygonThatCrossesItselfStillEnds) {
  EXPECT_EQ(triangulated({{0, 0}, {3, 3}, {3, 0}, {0, 3}, {1, 5}}).triangles.cols(), 3);
}

TEST(PolygonMesh, AttributesGoAlongToTheTrianglesOfTheirFace) {
  const ScratchFolder folder;
  const std::string vertices =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
      "property float z\nelement face 3\nproperty list uchar int vertex_indices\n"
      "property int id\nproperty list uchar float tags\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n-1 0.5 0\n";
  // A face without area, a square and a triangle: as many triangles as faces, but not the faces.
  write_text(folder / "mesh.ply",
             vertices + "3 0 1 1 10 1 0.1\n4 0 1 2 3 11 2 0.2 0.3\n3 0 3 4 12 0\n");
  const MeshFile file = read_mesh_file(folder / "mesh.ply");
  ASSERT_EQ(file.mesh.triangles.cols(), 3);
  EXPECT_EQ(*scalars(file.triangle_attributes, "id"), Eigen::Vector3d(11, 11, 12));
  const Attribute* tags = find_attribute(file.triangle_attributes, "tags");
  EXPECT_EQ(tags->list_sizes, (std::vector<int>{2, 2, 0}));
  EXPECT_EQ(std::get<std::vector<float>>(tags->values),
            (std::vector<float>{0.2F, 0.3F, 0.2F, 0.3F}));
}

TEST(PolygonMesh, ATriangleThatUsesAVertexTwiceIsLeftOut) {
  const ScratchFolder folder;
  write_text(folder / "mesh.obj", "v 0 0 1\nv 1 0 1\nv 1 1 1\nf 1 2 2\nf 1 2 3\n");
  EXPECT_EQ(read_mesh(folder / "mesh.obj").triangles.cols(), 1);
}

}  // namespace
}  // namespace palpate::geometry
