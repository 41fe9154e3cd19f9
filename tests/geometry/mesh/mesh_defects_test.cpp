// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_defects.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "broken_meshes.h"
#include "mesh_corpus.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

std::vector<int> elements(const TriangleMesh& mesh, DefectKind kind) {
  for (const MeshDefect& defect : find_defects(mesh)) {
    if (defect.kind == kind) return defect.elements;
  }
  return {};
}

TEST(MeshDefects, SoundMeshesHaveNone) {
  for (const TriangleMesh& mesh : {test::bumpy(5000, 0.25), test::icosphere(3, 10),
                                   test::closed_sheet(), test::torus(30, 9, 30.1, 4.7)}) {
    EXPECT_TRUE(find_defects(mesh).empty());
  }
}

TEST(MeshDefects, NeedlesAreToldFromTrianglesWithoutArea) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 10, 5, 5, 0, 0, 0.009, -0.0101, 0, 0, 0, 0;
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 1, 1, 0, 2, 3;
  EXPECT_EQ(elements(mesh, DefectKind::triangle_needle), std::vector{0});
  mesh.vertices(1, 2) = 0;
  EXPECT_EQ(elements(mesh, DefectKind::triangle_flat), std::vector{0});
  EXPECT_TRUE(elements(mesh, DefectKind::triangle_needle).empty());
}

TEST(MeshDefects, EachBrokenMeshShowsWhatWasBroken) {
  for (const test::BrokenMesh& broken : test::broken_meshes()) {
    EXPECT_EQ(elements(broken.mesh, broken.kind), broken.elements) << broken.name;
  }
}

TEST(MeshDefects, CornersThatAreNotThereHideNothingElse) {
  TriangleMesh mesh = test::icosphere(1, 10);
  mesh.triangles(1, 3) = -7;
  mesh.vertices(2, 5) = std::numeric_limits<double>::quiet_NaN();
  mesh.triangles.col(20).reverseInPlace();
  const std::vector<MeshDefect> defects = find_defects(mesh);
  ASSERT_EQ(defects.size(), 3U);
  EXPECT_EQ(defects[0].kind, DefectKind::infinite_vertex);
  EXPECT_EQ(defects[1].kind, DefectKind::corner_out_of_range);
  EXPECT_EQ(defects[2].kind, DefectKind::triangle_turned);
}

TEST(MeshDefects, TheDescriptionNamesTheFirstFew) {
  EXPECT_EQ(describe({DefectKind::vertex_isolated, {3, 8}}), "vertices in no triangle: 2 (3, 8)");
  EXPECT_EQ(describe({DefectKind::triangle_needle, {0, 1, 2, 3, 4, 5}}),
            "needle triangles: 6 (0, 1, 2, 3, 4, ...)");
}

TEST(MeshDefects, AnEmptyMeshHasNone) { EXPECT_TRUE(find_defects({}).empty()); }

}  // namespace
}  // namespace palpate::geometry
