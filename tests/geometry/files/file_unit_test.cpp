// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "file_testing.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::geometry {
namespace {

std::string ply(const std::string& comments) {
  return "ply\nformat ascii 1.0\n" + comments +
         "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "0.1 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
}

MeshFile read_ply_with(const std::string& comments, const ReadOptions& options = {}) {
  const ScratchFolder folder;
  write_text(folder / "mesh.ply", ply(comments));
  return read_mesh_file(folder / "mesh.ply", options);
}

TEST(FileUnit, IsTakenFromAComment) {
  const auto expect = [](const std::string& comment, double length) {
    const MeshFile file = read_ply_with("comment " + comment + "\ncomment another\n");
    EXPECT_EQ(file.unit.length, length) << comment;
    EXPECT_EQ(file.unit.source, UnitSource::declared) << comment;
    EXPECT_EQ(file.mesh.vertices(0, 0), 0.1 * length) << comment;
    EXPECT_EQ(file.comments, std::vector<std::string>{"another"});
  };
  expect("unit mm", 1);
  expect("unit: m", 1000);
  expect("UNITS = inches", 25.4);
  expect("Units: centimeters", 10);
  expect("unit=micrometre", 1e-3);
}

TEST(FileUnit, IsMmWhereNothingDeclaresIt) {
  for (const std::string comment : {"", "comment unit\n", "comment unit square of a pattern\n",
                                    "comment unit furlong\n", "comment in m\n"}) {
    const MeshFile file = read_ply_with(comment);
    EXPECT_EQ(file.unit.length, 1) << comment;
    EXPECT_EQ(file.unit.source, UnitSource::assumed) << comment;
    EXPECT_EQ(file.comments.size(), comment.empty() ? 0U : 1U);
  }
}

TEST(FileUnit, OfTheCallerGoesBeforeTheDeclaredOne) {
  const MeshFile file = read_ply_with("comment unit m\n", {.unit = 25.4});
  EXPECT_EQ(file.unit.length, 25.4);
  EXPECT_EQ(file.unit.source, UnitSource::stated);
  EXPECT_EQ(file.mesh.vertices(0, 1), 25.4);
  EXPECT_TRUE(file.comments.empty());  // files are now written in mm
}

TEST(FileUnit, TheFirstDeclarationCounts) {
  EXPECT_EQ(read_ply_with("comment unit cm\nobj_info unit m\n").unit.length, 10);
}

TEST(FileUnit, EveryFormatCanDeclareIt) {
  const ScratchFolder folder;
  const auto expect_metres = [&](const std::string& name, const std::string& content) {
    write_text(folder / name, content);
    const PointCloud cloud = read_point_cloud(folder / name);
    EXPECT_EQ(cloud.unit.length, 1000) << name;
    EXPECT_EQ(cloud.points(0, 1), 2000) << name;
    EXPECT_EQ(read_points(folder / name, {.unit = 1})(0, 1), 2) << name;
  };
  expect_metres("a.obj", "# unit: m\nv 0 0 0\nv 2 0 0\nv 0 1 0\n");
  expect_metres("a.off", "OFF # unit: m\n3 0\n0 0 0\n2 0 0\n0 1 0\n");
  expect_metres("a.pcd",
                "# .PCD\n# unit m\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA ascii\n"
                "0 0 0\n2 0 0\n");
  expect_metres("a.stl",
                "solid unit m\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\n"
                "vertex 0 1 0\nendloop\nendfacet\nendsolid\n");
}

TEST(FileUnit, WhatWeWriteDeclaresMm) {
  const ScratchFolder folder;
  const MeshFile file = read_ply_with("comment unit in\n");
  for (const char* name : {"a.ply", "a.obj", "a.stl"}) {
    write_mesh_file(folder / name, file);
    const MeshFile again = read_mesh_file(folder / name);
    EXPECT_EQ(again.unit.length, 1) << name;
    EXPECT_EQ(again.unit.source, UnitSource::declared) << name;
  }
  write_mesh(folder / "b.stl", file.mesh, {.encoding = Encoding::text});
  EXPECT_EQ(read_mesh_file(folder / "b.stl").unit.source, UnitSource::declared);
}

TEST(FileUnit, RefusesWhatIsNoUnit) {
  EXPECT_EQ(unit_length("CM"), 10);
  EXPECT_EQ(unit_length("inch"), 25.4);
  EXPECT_THROWS_MESSAGE(static_cast<void>(unit_length("furlong")), InvalidInput,
                        "use um, mm, cm, m or in");
  for (const double wrong : {0.0, -1.0, std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROWS_MESSAGE(static_cast<void>(read_ply_with("", {.unit = wrong})), InvalidInput,
                          "mm; it must be > 0 and finite");
}

TEST(FileUnit, RefusesALengthThatLeavesTheRange) {
  const ScratchFolder folder;
  write_text(folder / "mesh.obj", "# unit m\nv 0 0 0\nv 1 0 0\nv 0 1e307 0\nf 1 2 3\n");
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_mesh(folder / "mesh.obj")), FileError,
                        "vertex 2 times 1000");
}

}  // namespace
}  // namespace palpate::geometry
