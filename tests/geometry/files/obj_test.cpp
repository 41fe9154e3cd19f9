// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "file_testing.h"
#include "files/random_mesh_file.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::geometry {
namespace {

TriangleMesh read_obj(const std::string& content) {
  const ScratchFolder folder;
  write_text(folder / "mesh.obj", content);
  return read_mesh(folder / "mesh.obj");
}

const std::string kVertices = "# a square\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1.1\n";
const std::string kNormals = "vn 0 0 1\nvn 0 0.6 0.8\n";

TEST(Obj, ReadsEveryWayToNameACorner) {
  for (const char* face : {"f 1 2 3", "f 1/1 2/2 3/3", "f 1//1 2//1 3//2", "f 1/4/1 2/5/-1 3/6/-2",
                           "f -4 -3 -2", "  f\t1 2 3  # a comment", "f 1 \\\n 2 3", "f 1 2 3\r"}) {
    const TriangleMesh mesh = read_obj(kVertices + kNormals + face + "\n");
    EXPECT_EQ(mesh.vertices.cols(), 4) << face;
    ASSERT_EQ(mesh.triangles.cols(), 1) << face;
    EXPECT_EQ(mesh.triangles.col(0), Eigen::Vector3i(0, 1, 2)) << face;
  }
}

TEST(Obj, SkipsWhatIsNoGeometryAndKeepsDoubles) {
  const TriangleMesh mesh = read_obj(
      "mtllib none.mtl\no thing\nvn 0 0 1\nvt 0 0\nv 1000.0000000000001 0 1 0.5 0.5 0.5\n"
      "v 1 0 1\nv 1 1 1\ng a\nusemtl b\ns 1\nf 1 2 3\nl 1 2\n");
  EXPECT_EQ(mesh.vertices(0, 0), 1000.0000000000001);
  EXPECT_EQ(mesh.triangles.cols(), 1);
}

MeshFile read_obj_file(const std::string& content) {
  const ScratchFolder folder;
  write_text(folder / "mesh.obj", content);
  return read_mesh_file(folder / "mesh.obj");
}

TEST(Obj, NormalsAreKeptWhereEveryVertexHasOne) {
  const std::string two = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\nvn 0 0.6 0.8\nvn 0 0 1\n";
  const MeshFile file = read_obj_file(two + "f 1//1 2//2 3/1/1\nf 2//2 4//1 3//3\n");
  Eigen::Matrix3Xd expected(3, 4);
  expected << 0, 0, 0, 0, 0, 0.6, 0, 0, 1, 0.8, 1, 1;
  ASSERT_TRUE(normals(file.vertex_attributes));
  EXPECT_EQ(*normals(file.vertex_attributes), expected);
  EXPECT_FALSE(
      normals(read_obj_file(two + "f 1//1 2//2 3//1\nf 2//1 4//1 3//3\n").vertex_attributes));
  EXPECT_FALSE(normals(read_obj_file(two + "f 1//1 2//2 3//1\n").vertex_attributes));
  EXPECT_FALSE(normals(read_obj_file(two + "f 1 2 3 4\n").vertex_attributes));
}

TEST(Obj, ColorsAreKeptWhereEveryVertexHasOne) {
  const std::string faces = "f 1 2 3\n";
  const MeshFile file =
      read_obj_file("v 0 0 0 1 0 0\nv 1 0 0 0 0.1 0 # red\nv 0 1 0 0 0 1\n" + faces);
  ASSERT_TRUE(colors(file.vertex_attributes));
  EXPECT_EQ(colors(file.vertex_attributes)->col(1), Eigen::Vector4d(0, 0.1, 0, 1));
  EXPECT_TRUE(
      read_obj_file("v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 0 0 1\n" + faces).vertex_attributes.empty());
  EXPECT_TRUE(read_obj_file("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\n" + faces).vertex_attributes.empty());
}

TEST(Obj, NormalsColorsAndCommentsComeBack) {
  const ScratchFolder folder;
  MeshFile file = random_mesh_file(2);
  file.triangle_attributes.clear();
  file.vertex_attributes.clear();
  const Eigen::Index vertices = file.mesh.vertices.cols();
  std::mt19937_64 random(7);
  set_normals(file.vertex_attributes, random_points(vertices, random));
  for (const char* channel : {"red", "green", "blue"})
    set_attribute(file.vertex_attributes, {channel, std::vector<double>(42, 0.1), {}});
  write_mesh_file(folder / "mesh.obj", file);
  expect_same(read_mesh_file(folder / "mesh.obj"), file);
  // Bytes become numbers from 0 to 1, from which they can be told again.
  Eigen::Matrix3Xd bytes = Eigen::Matrix3Xd::NullaryExpr(
      3, vertices, [&] { return static_cast<double>(random() % 256) / 255; });
  set_colors(file.vertex_attributes, bytes);
  write_mesh_file(folder / "mesh.obj", file);
  EXPECT_EQ(colors(read_mesh_file(folder / "mesh.obj").vertex_attributes)->topRows<3>(), bytes);
}

TEST(Obj, PointsHaveTheirNormalsInOrder) {
  const ScratchFolder folder;
  write_text(folder / "a.obj", "v 0 0 0\nvn 0 0 1\nv 1 0 0\nvn 1 0 0\n");
  EXPECT_EQ(normals(read_point_cloud(folder / "a.obj").attributes)->col(1),
            Eigen::Vector3d(1, 0, 0));
}

TEST(Obj, RefusesWithTheLine) {
  const auto refuse = [](const std::string& content, const std::string& words) {
    EXPECT_THROWS_MESSAGE(static_cast<void>(read_obj(content)), FileError, words);
  };
  refuse(kVertices + "f 1 2 5\n", "line 6: \"5\" is not a vertex; 4 came before");
  refuse(kVertices + "f 1 2 0\n", "line 6");
  refuse(kVertices + "f 1 2 -5\n", "line 6");
  refuse(kVertices + "f 1 \\\n2 \\\n3\nf 1 2 x\n", "line 9: \"x\"");
  refuse(kVertices + kNormals + "f 1//1 2//1 3//3\n", "line 8: \"3\" is not a normal; 2 came");
  refuse(kVertices + "vn 0 0\n", "line 6: a normal needs three numbers, not 2");
  refuse(kVertices + "f 1 2\n", "line 6: a face needs at least 3 corners, not 2");
  refuse("v 0 0\n", "line 1: a vertex needs three numbers");
  refuse("v 0 0 1e\n", "not \"1e\"");
  refuse(kVertices, "no triangle");
  refuse("a letter\nto a friend\n", "not an OBJ file");
}

}  // namespace
}  // namespace palpate::geometry
