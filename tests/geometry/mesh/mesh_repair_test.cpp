// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_repair.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <utility>

#include "broken_meshes.h"
#include "mesh_corpus.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/mesh_topology.h"
#include "test_surfaces.h"
#include "told_progress.h"

namespace palpate::geometry {
namespace {

/// Oriented, manifold, and without a triangle that has no area.
void expect_sound(const TriangleMesh& mesh, const std::string& name) {
  EXPECT_NO_THROW((void)opposite_half_edges(mesh)) << name;
  for (const MeshDefect& defect : find_defects(mesh))
    EXPECT_EQ(defect.kind, DefectKind::triangle_needle) << name << ": " << describe(defect);
}

TEST(MeshRepair, AMeshWithoutDefectsComesBackAsItWas) {
  for (const TriangleMesh& mesh : {test::bumpy(5000, 0.25), test::glove(6), test::closed_sheet(),
                                   test::torus(30, 9, 30.1, 4.7)}) {
    const RepairedMesh repaired = repair_mesh(mesh);
    EXPECT_EQ(repaired.mesh.vertices, mesh.vertices);
    EXPECT_EQ(repaired.mesh.triangles, mesh.triangles);
    EXPECT_EQ(repaired.removed_triangles + repaired.turned_triangles + repaired.cut_edges, 0);
  }
}

TEST(MeshRepair, EachBrokenMeshIsMendedAndKeepsWhatWasSound) {
  for (const test::BrokenMesh& broken : test::broken_meshes()) {
    const RepairedMesh repaired = repair_mesh(broken.mesh);
    expect_sound(repaired.mesh, broken.name);
    // At most the triangles around one vertex go.
    EXPECT_GE(repaired.mesh.triangles.cols(), broken.mesh.triangles.cols() - 6) << broken.name;
    ASSERT_EQ(repaired.source.size(), static_cast<size_t>(repaired.mesh.vertices.cols()));
    for (Eigen::Index v = 0; v < repaired.mesh.vertices.cols(); ++v) {
      EXPECT_EQ(repaired.mesh.vertices.col(v),
                broken.mesh.vertices.col(repaired.source[static_cast<size_t>(v)]));
    }
  }
}

/// The defects other than needles and flat triangles, which do not concern the topology.
std::string topological_defects(const TriangleMesh& mesh) {
  std::string found;
  for (const MeshDefect& defect : find_defects(mesh)) {
    if (defect.kind != DefectKind::triangle_needle && defect.kind != DefectKind::triangle_flat)
      found += describe(defect) + "; ";
  }
  return found;
}

TEST(MeshRepair, AThirdTriangleIsSeparatedAlsoWhereItsFansAreJoinedAtBothEndsOfTheEdge) {
  TriangleMesh mesh;  // found by fuzzing
  mesh.vertices.resize(3, 6);
  mesh.vertices << 1, 1, 0, 0, 0, 0,  //
      1, 1, 0, 1, 0, 1,               //
      0, 0, 1, 0, 0, 1;
  mesh.triangles.resize(3, 5);
  mesh.triangles << 5, 3, 1, 0, 4,  //
      3, 0, 5, 3, 1,                //
      2, 2, 2, 5, 2;
  for (const double scale : {1.0, 1e37}) {
    const RepairedMesh repaired = repair_mesh(test::scaled(mesh, scale));
    EXPECT_EQ(topological_defects(repaired.mesh), "") << scale;
    EXPECT_NO_THROW((void)opposite_half_edges(repaired.mesh)) << scale;
    EXPECT_EQ(repaired.mesh.triangles.cols(), 5);
    EXPECT_GT(repaired.cut_edges, 0);
  }
}

TEST(MeshRepair, WhateverIsRepairedIsManifoldAtEveryScale) {
  int repaired_meshes = 0;
  for (const double scale : {1.0, 1e37, 1e155, 1e300}) {
    std::mt19937 random(7);
    for (int i = 0; i < 2000; ++i) {
      TriangleMesh mesh;
      mesh.vertices.resize(3, 4 + random() % 6);
      mesh.triangles.resize(3, 3 + random() % 12);
      const unsigned places = i % 2 == 0 ? 3 : 1000;  // a coarse grid has many coincidences
      for (double& x : mesh.vertices.reshaped()) x = scale * static_cast<double>(random() % places);
      for (int& v : mesh.triangles.reshaped())
        v = static_cast<int>(random() % static_cast<unsigned>(mesh.vertices.cols()));
      RepairedMesh repaired;
      try {
        repaired = repair_mesh(mesh);
      } catch (const InvalidInput&) {
        continue;  // no triangle can be kept
      }
      ++repaired_meshes;
      ASSERT_EQ(topological_defects(repaired.mesh), "") << scale << ", mesh " << i;
      ASSERT_NO_THROW((void)opposite_half_edges(repaired.mesh)) << scale << ", mesh " << i;
    }
  }
  EXPECT_GT(repaired_meshes, 7000);
}

TEST(MeshRepair, TrianglesTurnedAtRandomRunRoundAgainAsMostOfThemDid) {
  std::mt19937 random(5);
  TriangleMesh mesh = test::glove(6);
  const double right = enclosed_volume(mesh);
  int turned = 0;
  for (auto t : mesh.triangles.colwise()) {
    if (random() % 3 != 0) continue;
    t.reverseInPlace();
    ++turned;
  }
  const RepairedMesh repaired = repair_mesh(mesh);
  expect_sound(repaired.mesh, "glove");
  EXPECT_EQ(repaired.turned_triangles, turned);
  EXPECT_NEAR(enclosed_volume(repaired.mesh), right, 1e-9 * right);
}

TEST(MeshRepair, SolidsThatTouchAlongAnEdgeAreSeparatedAndKeepTheirOutside) {
  // Two tetrahedra on opposite sides of a common edge: the flattest angles are between their faces.
  const Eigen::Matrix3Xd vertices{{0, 0, 1, 1, -1, -1}, {0, 0, 1, -1, 1, -1}, {-1, 1, 0, 0, 0, 0}};
  const auto outwards = [&](Eigen::Vector3i t, const Eigen::Vector3d& centre) {
    const Eigen::Vector3d a = vertices.col(t[0]), b = vertices.col(t[1]), c = vertices.col(t[2]);
    if ((b - a).cross(c - a).dot(a - centre) < 0) std::swap(t[1], t[2]);
    return t;
  };
  TriangleMesh mesh{.vertices = vertices, .triangles = Eigen::Matrix3Xi(3, 8)};
  int t = 0;
  for (const int side : {2, 4}) {
    const std::array<int, 4> corners = {0, 1, side, side + 1};
    const Eigen::Vector3d centre = vertices(Eigen::all, corners).rowwise().mean();
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      const Eigen::Vector3i triangle(corners[(left_out + 1) % 4], corners[(left_out + 2) % 4],
                                     corners[(left_out + 3) % 4]);
      mesh.triangles.col(t++) = outwards(triangle, centre);
    }
  }
  const RepairedMesh repaired = repair_mesh(mesh);
  expect_sound(repaired.mesh, "tetrahedra");
  EXPECT_EQ(repaired.turned_triangles, 0);
  EXPECT_EQ(connected_components(repaired.mesh).count, 2);
  EXPECT_NEAR(enclosed_volume(repaired.mesh), 2 * 4.0 / 6, 1e-12);
}

TEST(MeshRepair, ATriangleSoupIsSewnTogether) {
  const TriangleMesh whole = test::icosphere(3, 10.1);
  TriangleMesh soup;
  soup.vertices.resize(3, whole.triangles.size());
  soup.triangles.resize(3, whole.triangles.cols());
  for (int i = 0; i < whole.triangles.size(); ++i) {
    soup.vertices.col(i) = whole.vertices.col(whole.triangles(i % 3, i / 3));
    soup.triangles(i % 3, i / 3) = i;
  }
  const RepairedMesh repaired = repair_mesh(soup);
  EXPECT_EQ(repaired.mesh.vertices.cols(), whole.vertices.cols());
  EXPECT_EQ((opposite_half_edges(repaired.mesh).array() < 0).count(), 0);
  EXPECT_EQ(repaired.welded_vertices, soup.vertices.cols() - whole.vertices.cols());
}

TEST(MeshRepair, ATJunctionIsClosedByFlippingItsFlatTriangle) {
  // A square of two triangles; the border of the lower one has a vertex in its middle that only a
  // flat triangle joins to it.
  TriangleMesh mesh;
  mesh.vertices.resize(3, 6);
  mesh.vertices << 0, 2, 2, 0, 1, 1, 0, 0, 2, 2, 0, -1, 0, 0, 0, 0, 0, 0;
  mesh.triangles.resize(3, 5);
  mesh.triangles << 0, 0, 1, 0, 4, 1, 2, 0, 5, 5, 2, 3, 4, 4, 1;
  const RepairedMesh repaired = repair_mesh(mesh);
  expect_sound(repaired.mesh, "T junction");
  EXPECT_EQ(repaired.flipped_edges, 1);
  EXPECT_EQ(repaired.removed_triangles, 0);
  EXPECT_DOUBLE_EQ(surface_area(repaired.mesh), surface_area(mesh));
  EXPECT_EQ((opposite_half_edges(repaired.mesh).array() < 0).count(), 5);
}

TEST(MeshRepair, AChainOfFlatTrianglesIsFlippedToItsEnd) {
  // Vertices in line along the long side of a triangle, joined to it by a fan of flat triangles
  // from the first one, which only the last of them lets begin.
  constexpr int kChain = 60;
  TriangleMesh mesh;
  mesh.vertices = Eigen::Matrix3Xd::Zero(3, kChain + 2);
  for (int i = 0; i <= kChain; ++i) mesh.vertices(0, i) = i;
  mesh.vertices.col(kChain + 1) << kChain / 3.0, kChain, 0;
  mesh.triangles.resize(3, kChain);
  mesh.triangles.col(0) << 0, kChain, kChain + 1;
  for (int i = 1; i < kChain; ++i) mesh.triangles.col(i) << 0, i, i + 1;
  const RepairedMesh repaired = repair_mesh(mesh);
  expect_sound(repaired.mesh, "chain");
  EXPECT_EQ(repaired.flipped_edges, kChain - 1);
  EXPECT_EQ(repaired.removed_triangles, 0);
  EXPECT_NEAR(surface_area(repaired.mesh), surface_area(mesh), 1e-12 * surface_area(mesh));
  EXPECT_EQ((opposite_half_edges(repaired.mesh).array() < 0).count(), kChain + 2);
}

TEST(MeshRepair, FansThatMeetAtAVertexAreSeparatedAndCounted) {
  // Three triangles that have only their first corner in common.
  TriangleMesh mesh;
  mesh.vertices.resize(3, 7);
  mesh.vertices << 0, 1, 1, -1, -1, 0, 0, 0, 0, 1, 0, 1, 1, 1, 0, 0, 0, 0, 0, 1, 2;
  mesh.triangles.resize(3, 3);
  mesh.triangles << 0, 0, 0, 1, 3, 5, 2, 4, 6;
  const RepairedMesh repaired = repair_mesh(mesh);
  expect_sound(repaired.mesh, "fans");
  EXPECT_EQ(repaired.split_vertices, 2);
  EXPECT_EQ(repaired.mesh.vertices.cols(), 9);
}

TEST(MeshRepair, AFinIsCutOffAndTheSheetStaysWhole) {
  for (const test::BrokenMesh& broken : test::broken_meshes()) {
    if (broken.kind != DefectKind::edge_overfull) continue;
    const RepairedMesh repaired = repair_mesh(broken.mesh);
    EXPECT_EQ(repaired.cut_edges, 1);
    EXPECT_EQ(repaired.mesh.triangles.cols(), broken.mesh.triangles.cols());
    EXPECT_EQ(repaired.mesh.vertices.cols(), broken.mesh.vertices.cols() + 2);
    // The outline of the sheet of 4 x 3 squares, and that of the fin.
    EXPECT_EQ((opposite_half_edges(repaired.mesh).array() < 0).count(), 14 + 3);
  }
}

TEST(MeshRepair, AMobiusStripIsCutOnce) {
  constexpr int kLength = 20;
  TriangleMesh strip;
  strip.vertices.resize(3, 2 * kLength);
  strip.triangles.resize(3, 2 * kLength);
  for (int i = 0; i < kLength; ++i) {
    const double u = 2 * std::numbers::pi * i / kLength;
    for (int side = 0; side < 2; ++side) {
      const double w = side == 0 ? -1.3 : 1.3;
      strip.vertices.col(2 * i + side) << (10 + w * std::cos(u / 2)) * std::cos(u),
          (10 + w * std::cos(u / 2)) * std::sin(u), w * std::sin(u / 2);
    }
    const bool last = i + 1 == kLength;
    const int c = last ? 1 : 2 * i + 2;
    const int d = last ? 0 : 2 * i + 3;
    strip.triangles.col(2 * i) << 2 * i, c, d;
    strip.triangles.col(2 * i + 1) << 2 * i, d, 2 * i + 1;
  }
  const RepairedMesh repaired = repair_mesh(strip);
  expect_sound(repaired.mesh, "strip");
  EXPECT_EQ(repaired.cut_edges, 1);
  EXPECT_EQ(repaired.mesh.triangles.cols(), strip.triangles.cols());
}

TEST(MeshRepair, RandomTrianglesBecomeManifold) {
  std::mt19937 random(3);
  for (int run = 0; run < 50; ++run) {
    TriangleMesh mesh = test::icosphere(1, 10);
    for (int& corner : mesh.triangles.reshaped()) {
      if (random() % 4 == 0) corner = static_cast<int>(random() % 44) - 1;
    }
    expect_sound(repair_mesh(mesh).mesh, "run " + std::to_string(run));
  }
}

TEST(MeshRepair, TellsItsProgress) {
  // A flat triangle takes a round of flips, which is told too.
  TriangleMesh mesh = test::flat_sheet(4, 4, 1);
  mesh.vertices.col(6) = (mesh.vertices.col(5) + mesh.vertices.col(7)) / 2;
  mesh.vertices.col(11) = mesh.vertices.col(6) * 2 - mesh.vertices.col(1);
  check_progress([&](const auto& progress) { (void)repair_mesh(mesh, {.progress = progress}); }, 7);
}

TEST(MeshRepair, RefusesWhenNothingCanBeKept) {
  TriangleMesh mesh = test::flat_sheet(1, 1, 1);
  mesh.vertices.row(0).setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW((void)repair_mesh(mesh), InvalidInput);
  EXPECT_THROW((void)repair_mesh({}), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
