// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_io.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "file_testing.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_measures.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

/// Coordinates with all bits of the mantissa in use.
TriangleMesh awkward_mesh() {
  TriangleMesh mesh = test::icosphere(2, 100.1);
  mesh.vertices.colwise() += Eigen::Vector3d(1e-7 / 3, 1e6 / 3, -0.1);
  return mesh;
}

const std::string kTetrahedronOff =
    "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

TEST(MeshIo, RoundTripsEveryBitOfPlyAndObj) {
  const ScratchFolder folder;
  const TriangleMesh mesh = awkward_mesh();
  for (const char* name : {"mesh.ply", "mesh.obj", "MESH.PLY"}) {
    write_mesh(folder / name, mesh);
    const TriangleMesh read = read_mesh(folder / name);
    EXPECT_EQ(read.vertices, mesh.vertices) << name;
    EXPECT_EQ(read.triangles, mesh.triangles) << name;
    EXPECT_EQ(read_points(folder / name), mesh.vertices) << name;
  }
}

TEST(MeshIo, PutsThePartsOfASceneWhereItPlacesThem) {
  const ScratchFolder folder;
  // One tetrahedron twice: moved by 10 in x within a part that is doubled, and mirrored in z, which
  // turns its faces inside out.
  std::string bytes;
  for (const Eigen::Vector3d& corner : kTetrahedronCorners)
    for (const double x : corner) {
      const auto raw = std::bit_cast<std::array<char, 4>>(static_cast<float>(x));
      bytes.append(raw.data(), raw.size());
    }
  for (const Eigen::Vector3i& face : kTetrahedronFaces)
    for (const int corner : face) bytes += {static_cast<char>(corner), '\0'};
  write_text(folder / "mesh.bin", bytes);
  write_text(folder / "mesh.gltf", R"({"asset": {"version": "2.0"}, "scene": 0,
    "scenes": [{"nodes": [0, 1]}],
    "nodes": [{"children": [2], "scale": [2, 2, 2]}, {"mesh": 0, "scale": [1, 1, -1]},
              {"mesh": 0, "translation": [10, 0, 0]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "buffers": [{"uri": "mesh.bin", "byteLength": 72}],
    "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
    "accessors": [
      {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
      {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}]})");
  const TriangleMesh mesh = read_mesh(folder / "mesh.gltf");
  EXPECT_EQ(mesh.triangles.cols(), 8);
  EXPECT_EQ(mesh.vertices.cols(), 8);
  EXPECT_EQ(mesh.vertices.row(0).maxCoeff(), 22000);  // glTF is in metres
  EXPECT_EQ(mesh.vertices.row(2).minCoeff(), -1000);
  EXPECT_NEAR(enclosed_volume(mesh), 9e9 / 6, 1e-3);
}

/// One triangle with normals and colours, stretched along z.
const std::string kColoredGltf = R"({"asset": {"version": "2.0"}, "scene": 0,
    "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "scale": [1, 1, 2]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "COLOR_0": 2}}]}],
    "buffers": [{"uri": "mesh.bin", "byteLength": 120}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 36},
      {"buffer": 0, "byteOffset": 72, "byteLength": 48}],
    "accessors": [
      {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
      {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"},
      {"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC4"}]})";

TEST(MeshIo, KeepsTheNormalsAndColorsOfAScene) {
  const ScratchFolder folder;
  std::string bytes;
  const auto put = [&](std::initializer_list<float> numbers) {
    for (const float number : numbers) {
      const auto raw = std::bit_cast<std::array<char, 4>>(number);
      bytes.append(raw.data(), raw.size());
    }
  };
  // In the plane x = z, and so are its normals of (-1 0 1); stretched twofold, it is 2 x = z.
  put({0, 0, 0, 1, 0, 1, 0, 1, 0});
  for (int i = 0; i < 3; ++i) put({-std::sqrt(0.5F), 0, std::sqrt(0.5F)});
  for (int i = 0; i < 3; ++i) put({1, 0.25, 0, 0.5});
  write_text(folder / "mesh.bin", bytes);
  write_text(folder / "mesh.gltf", kColoredGltf);
  const MeshFile file = read_mesh_file(folder / "mesh.gltf");
  EXPECT_EQ(file.unit.source, UnitSource::declared);
  EXPECT_EQ(file.mesh.vertices.col(1), Eigen::Vector3d(1000, 0, 2000));
  ASSERT_TRUE(normals(file.vertex_attributes));
  EXPECT_LE((*normals(file.vertex_attributes) - vertex_normals(file.mesh)).norm(), 1e-6);  // float
  ASSERT_TRUE(colors(file.vertex_attributes));
  // A quarter of the light is 137 of 255 on a screen (IEC 61966-2-1).
  const Eigen::Vector4d expected(1, 137.0 / 255, 0, 0.5);
  EXPECT_LE((colors(file.vertex_attributes)->col(2) - expected).norm(), 1e-3);
}

TEST(MeshIo, RefusesWhatIsMissingEmptyGarbageOrOfAnotherKind) {
  const ScratchFolder folder;
  for (const char* ending : {".ply", ".obj", ".stl", ".off", ".pcd"}) {
    const std::string name = std::string("mesh") + ending;
    EXPECT_THROWS_MESSAGE(static_cast<void>(read_points(folder / name)), FileError,
                          name + ": no such file");
    write_text(folder / name, "");
    EXPECT_THROWS_MESSAGE(static_cast<void>(read_points(folder / name)), FileError,
                          name + ": is empty");
    write_text(folder / name, "a letter\nto a friend\n");
    EXPECT_THROWS_MESSAGE(static_cast<void>(read_points(folder / name)), FileError, name);
    EXPECT_THROWS_MESSAGE(static_cast<void>(read_mesh(folder / name)), FileError, name);
  }
  write_text(folder / "mesh.txt", kTetrahedronOff);
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_mesh(folder / "mesh.txt")), FileError,
                        "\".txt\" is not that of a mesh; .ply, .obj, .stl and .off are");
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_mesh(folder.path())), FileError,
                        "is a folder; expected a file");
}

// Assimp claims .step, and then says that a right file is damaged.
TEST(MeshIo, RefusesSolidsOfCadProgramsByTheirEnding) {
  const ScratchFolder folder;
  for (const char* name : {"gear.step", "gear.STP", "gear.iges"}) {
    write_text(folder / name, "ISO-10303-21;\nHEADER;\nENDSEC;\nEND-ISO-10303-21;\n");
    EXPECT_THROWS_MESSAGE(static_cast<void>(read_mesh(folder / name)), FileError,
                          "such files hold solids with curved faces");
  }
}

TEST(MeshIo, LeavesEndingsOfAssimpToAssimp) {
  const ScratchFolder folder;
  for (const char* name : {"a.3ds", "a.dae", "a.fbx", "a.x3d", "a.lwo", "a.ifc"}) {
    write_text(folder / name, "to a friend\n");
    EXPECT_THROWS_MESSAGE(static_cast<void>(read_mesh(folder / name)), FileError, "is damaged");
  }
}

TEST(MeshIo, RefusesWhatAssimpFindsDamaged) {
  const ScratchFolder folder;
  write_text(folder / "mesh.glb", "glTF" + std::string(60, '\1'));
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_mesh(folder / "mesh.glb")), FileError,
                        "is damaged or truncated");
}

TEST(MeshIo, RefusesToWriteAnotherFormatOrABadMesh) {
  const ScratchFolder folder;
  EXPECT_THROWS_MESSAGE(write_mesh(folder / "mesh.off", awkward_mesh()), InvalidInput,
                        "as .ply, .obj, .stl, .glb or .vtk, not as \".off\"");
  TriangleMesh mesh = awkward_mesh();
  mesh.vertices(1, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROWS_MESSAGE(write_mesh(folder / "mesh.ply", mesh), InvalidInput,
                        "vertex 3 is not finite");
  EXPECT_EQ(folder.entries(), 0);
}

TEST(MeshIo, KeepsTheOldFileWhenTheDiskIsFull) {
  const ScratchFolder folder;
  for (const char* name : {"mesh.ply", "mesh.obj"}) {
    write_text(folder / name, "old");
    const FullDisk disk(100);
    EXPECT_THROWS_MESSAGE(write_mesh(folder / name, awkward_mesh()), OutputError, name);
    EXPECT_EQ(read_text(folder / name), "old");
  }
  EXPECT_EQ(folder.entries(), 2);
}

}  // namespace
}  // namespace palpate::geometry
