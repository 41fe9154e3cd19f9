// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "palpate/core/error.h"
#include "palpate/probing/finite_element_mesh.h"

namespace palpate::probing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class GmshFile : public ::testing::Test {
 protected:
  FiniteElementMesh read(const std::string& text) {
    std::ofstream(path_) << text;
    return read_gmsh(path_);
  }
  std::string refusal(const std::string& text) {
    try {
      (void)read(text);
    } catch (const FileError& e) {
      return e.what();
    }
    return "";
  }
  void TearDown() override { std::filesystem::remove(path_); }
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() /
      ("palpate_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) +
       ".msh");
};

// Two tetrahedra of a corner, the second in group 7, a triangle, and a node that is not used.
constexpr const char* kOld = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
1
3 7 "nodule"
$EndPhysicalNames
$Nodes
6
1 0 0 0
2 4 0 0
3 0 4 0
4 0 0 4
9 4 4 4
12 50 50 50
$EndNodes
$Elements
3
1 2 2 0 1 1 2 3
2 4 2 0 1 1 2 3 4
3 4 2 7 2 2 3 4 9
$EndElements
)";

constexpr const char* kNew = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$Entities
1 0 0 2
1 0 0 0 0
1 0 0 0 4 4 4 0 0
2 0 0 0 4 4 4 1 7 0
$EndEntities
$Nodes
2 6 1 12
3 1 0 4
1
2
3
4
0 0 0
4 0 0
0 4 0
0 0 4
3 2 0 2
9
12
4 4 4
50 50 50
$EndNodes
$Elements
2 2 1 2
3 1 4 1
1 1 2 3 4
3 2 4 1
2 2 3 4 9
$EndElements
)";

TEST_F(GmshFile, BothVersionsGiveTheSameMesh) {
  const FiniteElementMesh old = read(kOld), recent = read(kNew);
  EXPECT_EQ(old.nodes.cols(), 5 + 9);  // corners and edges
  EXPECT_THAT(old.regions, ElementsAre(0, 7));
  EXPECT_NEAR(volume(old), 64.0 / 6 + 64.0 / 3, 1e-12);
  EXPECT_EQ(old.nodes, recent.nodes);
  EXPECT_EQ(old.elements, recent.elements);
  EXPECT_EQ(old.regions, recent.regions);
  EXPECT_NO_THROW(check_finite_element_mesh(old));
}

TEST_F(GmshFile, QuadraticElementsKeepTheirNodes) {
  // In Gmsh's order the last two middles are those of edges 23 and 13.
  const FiniteElementMesh mesh = read(R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
10
1 0 0 0
2 2 0 0
3 0 2 0
4 0 0 2
5 1 0 0
6 1 1 0
7 0 1 0
8 0 0 1
9 0 1 1
10 1 0 1
$EndNodes
$Elements
1
1 11 2 0 1 1 2 3 4 5 6 7 8 9 10
$EndElements
)");
  EXPECT_EQ(mesh.nodes.col(mesh.elements(8, 0)), Eigen::Vector3d(1, 0, 1));
  EXPECT_NO_THROW(check_finite_element_mesh(mesh));
  EXPECT_NEAR(volume(mesh), 8.0 / 6, 1e-14);
}

std::string without(std::string text, const std::string& what, const std::string& with) {
  return text.replace(text.find(what), what.size(), with);
}

TEST_F(GmshFile, SaysWhatIsWrong) {
  EXPECT_THAT(refusal(""), HasSubstr("has no tetrahedra"));
  EXPECT_THAT(refusal("$Nodes\n"), HasSubstr("line 1: is not a Gmsh file"));
  EXPECT_THAT(refusal(without(kOld, "2.2 0", "2.2 1")), HasSubstr("line 2: binary files"));
  EXPECT_THAT(refusal(without(kOld, "2.2 0", "4.0 0")), HasSubstr("version 4 is not read"));
  EXPECT_THAT(refusal(without(kOld, "2 4 0 0", "2 4 x 0")), HasSubstr("line 11: '2 4 x 0'"));
  EXPECT_THAT(refusal(without(kOld, "2 3 4 9", "2 3 4 8")), HasSubstr("node 8 of an element"));
  EXPECT_THAT(refusal(without(kOld, "2 3 4 9", "2 3 4")), HasSubstr("must have 4 nodes"));
  EXPECT_THAT(refusal(without(kOld, "\n9 4 4 4", "\n4 4 4 4")), HasSubstr("node 4 is there twice"));
  EXPECT_THAT(refusal(std::string(kOld).substr(0, 100)), HasSubstr("line "));
  EXPECT_THROW((void)read_gmsh("/does/not/exist.msh"), FileError);
}

}  // namespace
}  // namespace palpate::probing
