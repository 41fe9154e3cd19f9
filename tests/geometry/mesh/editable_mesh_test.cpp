// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "mesh/editable_mesh.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "mesh_corpus.h"
#include "palpate/geometry/mesh_defects.h"
#include "palpate/geometry/mesh_topology.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

/// Half-edges that leave each vertex are found once each, and neighbours agree with each other.
void expect_consistent(const EditableMesh& mesh) {
  std::vector<int> found(static_cast<size_t>(mesh.half_edge_count()), 0);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    mesh.each_leaving(v, [&](int h) {
      ASSERT_EQ(mesh.start(h), v);
      ++found[static_cast<size_t>(h)];
    });
  }
  for (int h = 0; h < mesh.half_edge_count(); ++h) {
    ASSERT_EQ(found[static_cast<size_t>(h)], mesh.is_live(h) ? 1 : 0) << h;
    const int g = mesh.opposite(h);
    if (!mesh.is_live(h) || g < 0) continue;
    ASSERT_EQ(mesh.opposite(g), h);
    ASSERT_EQ(mesh.start(g), mesh.end(h));
    ASSERT_EQ(mesh.is_feature(g), mesh.is_feature(h));
  }
}

TEST(EditableMesh, StaysAManifoldOfTheSameTopologyInRandomChanges) {
  for (const TriangleMesh& input : {test::icosphere(1, 5), test::torus(8, 5, 20, 6),
                                    test::flat_sheet(6, 5, 1), test::bumpy(300)}) {
    EditableMesh mesh(input, "test");
    std::minstd_rand random(3);
    for (int i = 0; i < 4000; ++i) {
      const int h = static_cast<int>(random() % static_cast<unsigned long>(mesh.half_edge_count()));
      if (!mesh.is_live(h)) continue;
      const auto change = random() % 3;
      if (change == 0 && mesh.triangle_count() < 2 * input.triangles.cols()) {
        const int middle = mesh.split(h);
        EXPECT_EQ(middle, mesh.vertex_count() - 1);
      } else if (change == 1 && mesh.can_flip(h)) {
        mesh.flip(h);
      } else if (change == 2 && mesh.can_collapse(h)) {
        mesh.collapse(h);
      }
      if (i % 100 == 0) expect_consistent(mesh);
    }
    const TriangleMesh result = mesh.mesh();
    EXPECT_EQ(result.triangles.cols(), mesh.triangle_count());
    EXPECT_EQ(euler_characteristic(result), euler_characteristic(input));
    EXPECT_EQ(boundary_loops(result).size(), boundary_loops(input).size());
    for (const MeshDefect& defect : find_defects(result)) {
      EXPECT_GE(static_cast<int>(defect.kind), static_cast<int>(DefectKind::triangle_flat))
          << describe(defect);  // flat and thin ones are expected here
    }
  }
}

TEST(EditableMesh, CollapsesDownToATetrahedronAndNoFurther) {
  EditableMesh mesh(test::icosphere(2, 5), "test");
  for (bool changed = true; changed;) {
    changed = false;
    for (int h = 0; h < mesh.half_edge_count(); ++h) {
      if (!mesh.is_live(h) || !mesh.can_collapse(h)) continue;
      mesh.collapse(h);
      changed = true;
    }
  }
  EXPECT_EQ(mesh.triangle_count(), 4);
  EXPECT_EQ(euler_characteristic(mesh.mesh()), 2);
}

TEST(EditableMesh, KeepsFeaturesWhenTheirTrianglesChange) {
  EditableMesh mesh(test::flat_sheet(4, 4, 1), "test");
  double length = 0;
  for (int h = 0; h < mesh.half_edge_count(); ++h) {  // the line x = 2
    const auto is_on = [&](int v) { return mesh.at(v).x() == 2; };
    if (!is_on(mesh.start(h)) || !is_on(mesh.end(h)) || mesh.start(h) > mesh.end(h)) continue;
    mesh.make_feature(h);
    length += mesh.length(h);
  }
  EXPECT_EQ(length, 4);
  std::minstd_rand random(5);
  for (int i = 0; i < 500; ++i) {
    const int h = static_cast<int>(random() % static_cast<unsigned long>(mesh.half_edge_count()));
    if (i % 2 == 0 && mesh.triangle_count() < 200) mesh.split(h);
    if (i % 2 == 1 && mesh.can_flip(h)) mesh.flip(h);
  }
  double after = 0;
  for (int h = 0; h < mesh.half_edge_count(); ++h) {
    if (!mesh.is_feature(h) || h < mesh.opposite(h)) continue;
    EXPECT_EQ(mesh.at(mesh.start(h)).x(), 2);
    EXPECT_EQ(mesh.at(mesh.end(h)).x(), 2);
    after += mesh.length(h);
  }
  EXPECT_NEAR(after, 4, 1e-12);
}

}  // namespace
}  // namespace palpate::geometry
