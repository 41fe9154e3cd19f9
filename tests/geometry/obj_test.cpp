// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "file_testing.h"
#include "palpate/error.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::geometry {
namespace {

TriangleMesh read(const std::string& content) {
  const ScratchFolder folder;
  write_text(folder / "mesh.obj", content);
  return read_mesh(folder / "mesh.obj");
}

const std::string kVertices = "# a square\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1.1\n";
const std::string kNormals = "vn 0 0 1\nvn 0 0.6 0.8\n";

TEST(Obj, ReadsEveryWayToNameACorner) {
  for (const char* face : {"f 1 2 3", "f 1/1 2/2 3/3", "f 1//1 2//1 3//2", "f 1/4/1 2/5/-1 3/6/-2",
                           "f -4 -3 -2", "  f\t1 2 3  # a comment", "f 1 \\\n 2 3", "f 1 2 3\r"}) {
    const TriangleMesh mesh = read(kVertices + kNormals + face + "\n");
    EXPECT_EQ(mesh.vertices.cols(), 4) << face;
    ASSERT_EQ(mesh.triangles.cols(), 1) << face;
    EXPECT_EQ(mesh.triangles.col(0), Eigen::Vector3i(0, 1, 2)) << face;
  }
}

TEST(Obj, SkipsWhatIsNoGeometryAndKeepsDoubles) {
  const TriangleMesh mesh = read(
      "mtllib none.mtl\no thing\nvn 0 0 1\nvt 0 0\nv 1000.0000000000001 0 1 0.5 0.5 0.5\n"
      "v 1 0 1\nv 1 1 1\ng a\nusemtl b\ns 1\nf 1 2 3\nl 1 2\n");
  EXPECT_EQ(mesh.vertices(0, 0), 1000.0000000000001);
  EXPECT_EQ(mesh.triangles.cols(), 1);
}

TEST(Obj, RefusesWithTheLine) {
  const auto refuse = [](const std::string& content, const std::string& words) {
    EXPECT_THROWS_MESSAGE(static_cast<void>(read(content)), FileError, words);
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
