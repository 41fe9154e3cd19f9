// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/texture.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "file_testing.h"
#include "files/random_mesh_file.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/mesh_repair.h"
#include "refusal.h"

namespace palpate::geometry {
namespace {

MeshFile read(const std::string& name, const std::string& content, bool keep_defects = false) {
  const ScratchFolder folder;
  write_text(folder / name, content);
  return read_mesh_file(folder / name, {.unit = {}, .keep_defects = keep_defects});
}

/// Two squares that share an edge, at which the picture is cut; the second has another material.
const std::string kCut =
    "mtllib two words.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n"
    "vt 0 0\nvt 0.5 0\nvt 0.5 0.25\nvt 0 0.25\nvt 0.1 0.9 0\nvt 0.2 0.9\n"
    "usemtl skin\nf 1/1 2/2 3/3 4/4\nusemtl cloth\nf 2/5 5/6 6/-1\nf 2 6 3\n";

TEST(Texture, OfAnObjFileIsThatOfItsCorners) {
  const MeshFile file = read("a.obj", kCut);
  EXPECT_EQ(file.material_files, std::vector<std::string>{"two words.mtl"});
  EXPECT_EQ(file.materials, (std::vector<std::string>{"skin", "cloth"}));
  const auto texture = corner_texture(file.triangle_attributes);
  ASSERT_TRUE(texture);
  ASSERT_EQ(texture->coordinates.cols(), 4);
  EXPECT_EQ(texture->number, Eigen::Vector4i(0, 0, 1, 1));
  // The picture on the square is its lower left half, or quarter, of the unit square.
  for (Eigen::Index t = 0; t < 2; ++t) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d corner = file.mesh.vertices.col(file.mesh.triangles(k, t));
      EXPECT_EQ(texture->coordinates(2 * k, t), 0.5 * corner.x());
      EXPECT_EQ(texture->coordinates(2 * k + 1, t), 0.25 * corner.y());
    }
  }
  Eigen::Matrix<double, 6, 1> cloth;
  cloth << 0.1, 0.9, 0.2, 0.9, 0.2, 0.9;
  EXPECT_EQ(texture->coordinates.col(2), cloth);
  EXPECT_TRUE(texture->coordinates.col(3).array().isNaN().all());
}

TEST(Texture, OfPolygonsInPlyIsDividedAmongTheirTriangles) {
  const std::string header =
      "ply\nformat ascii 1.0\ncomment TextureFile skin.png\nelement vertex 4\nproperty double x\n"
      "property double y\nproperty double z\nelement face 1\n"
      "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
      "0 0 0\n2 0 0\n2 2 0\n0 2 0\n";
  const MeshFile file = read("a.ply", header + "4 0 1 2 3 8 0 0 1 0 1 1 0 1\n");
  const auto texture = corner_texture(file.triangle_attributes);
  ASSERT_TRUE(texture);
  ASSERT_EQ(texture->coordinates.cols(), 2);
  EXPECT_EQ(texture->number.size(), 0);
  for (Eigen::Index t = 0; t < 2; ++t) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d corner = file.mesh.vertices.col(file.mesh.triangles(k, t));
      EXPECT_EQ((texture->coordinates.block<2, 1>(2 * k, t)), 0.5 * corner.head<2>());
    }
  }
  // A list that does not fit the polygon counts as none.
  const auto other =
      corner_texture(read("a.ply", header + "4 0 1 2 3 6 0 0 1 0 1 1\n").triangle_attributes);
  ASSERT_TRUE(other);
  EXPECT_TRUE(other->coordinates.array().isNaN().all());
}

TEST(Texture, ComesBackFromObjAndPly) {
  const ScratchFolder folder;
  MeshFile file = read("a.obj", kCut);
  for (const char* name : {"b.obj", "b.ply"}) {
    write_mesh_file(folder / name, file);
    const MeshFile again = read_mesh_file(folder / name);
    const auto expected = corner_texture(file.triangle_attributes);
    const auto texture = corner_texture(again.triangle_attributes);
    ASSERT_TRUE(texture && expected);
    EXPECT_TRUE(texture->coordinates.cwiseEqual(expected->coordinates)
                    .cwiseMax(texture->coordinates.array().isNaN().matrix())
                    .all());
    EXPECT_EQ(texture->number, expected->number);
    EXPECT_EQ(again.mesh.triangles, file.mesh.triangles);
  }
  const MeshFile again = read_mesh_file(folder / "b.obj");
  EXPECT_EQ(again.materials, file.materials);
  EXPECT_EQ(again.material_files, file.material_files);
  // Float coordinates, as most PLY files have them, stay float.
  Attributes attributes;
  set_corner_texture(attributes,
                     {.coordinates = Eigen::Matrix<double, 6, 2>::Constant(0.25), .number = {}});
  ASSERT_EQ(attributes.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<std::vector<float>>(attributes[0].values));
}

TEST(Texture, MaterialsWithoutAPictureAreNumbersAlone) {
  const MeshFile file =
      read("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nusemtl red\nf 1 3 4\n");
  const auto texture = corner_texture(file.triangle_attributes);
  ASSERT_TRUE(texture);
  EXPECT_EQ(texture->number, Eigen::Vector2i(-1, 0));
  EXPECT_TRUE(texture->coordinates.array().isNaN().all());
  EXPECT_FALSE(
      corner_texture(read("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n").triangle_attributes));
}

TEST(Texture, GoesThroughRepairAndFilling) {
  // The second square is turned over, and one of its corners is a vertex of its own.
  const std::string turned =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nv 1 0 0\n"
      "vt 0 0\nvt 0.5 0\nvt 0.5 0.25\nvt 0 0.25\nvt 1 0\nvt 1 0.25\n"
      "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 7/2 6/6 5/5\nf 7/2 3/3 6/6\nf 1/1 1/1 2/2\n";
  const MeshFile file = read("a.obj", turned, true);
  const RepairedMesh repaired = repair_mesh(file.mesh);
  EXPECT_GT(repaired.turned_triangles, 0);
  const CornerTexture texture = carried_texture(*corner_texture(file.triangle_attributes),
                                                file.mesh, repaired.mesh, repaired.source);
  ASSERT_EQ(repaired.mesh.triangles.cols(), 4);
  for (Eigen::Index t = 0; t < 4; ++t) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d corner = repaired.mesh.vertices.col(repaired.mesh.triangles(k, t));
      EXPECT_EQ(texture.coordinates(2 * k, t), 0.5 * corner.x());
      EXPECT_EQ(texture.coordinates(2 * k + 1, t), 0.25 * corner.y());
    }
  }
  // A new triangle has none.
  TriangleMesh more = repaired.mesh;
  more.triangles.conservativeResize(3, 5);
  more.triangles.col(4) << 0, 1, 5;
  const CornerTexture filled =
      carried_texture(texture, repaired.mesh, more, std::vector<int>{0, 1, 2, 3, 4, -1});
  EXPECT_EQ(filled.coordinates.col(0), texture.coordinates.col(0));
  EXPECT_TRUE(filled.coordinates.col(4).array().isNaN().all());
  EXPECT_NE(refusal([&] { return carried_texture(texture, more, more, {}); }).find("triangles"),
            std::string::npos);
}

TEST(Texture, RefusesWithTheLine) {
  EXPECT_THROWS_MESSAGE(static_cast<void>(read("a.obj", kCut + "f 1/1 2/2 3/7\n")), FileError,
                        "line 19: \"7\" is not a texture coordinate; 6 came before");
  EXPECT_THROWS_MESSAGE(static_cast<void>(read("a.obj", kCut + "vt x\n")), FileError,
                        "line 19: a texture coordinate needs a number, not \"x\"");
}

}  // namespace
}  // namespace palpate::geometry
