// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/hole_filling.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "cgal_availability.h"
#include "mesh_corpus.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_defects.h"
#include "palpate/geometry/mesh_topology.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

/// The mesh without the triangles whose centre is within `radius` of a place.
TriangleMesh with_hole(const TriangleMesh& mesh, const Eigen::Vector3d& at, double radius) {
  std::vector<int> kept;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Matrix3d corners = mesh.vertices(Eigen::all, mesh.triangles.col(t));
    if ((corners.rowwise().mean() - at).norm() > radius) kept.push_back(t);
  }
  return {mesh.vertices, mesh.triangles(Eigen::all, kept)};
}

class HoleFilling : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::has_cgal()) GTEST_SKIP() << "the library was built without CGAL";
  }
};

TEST_F(HoleFilling, APatchOnASphereFollowsTheSphere) {
  const double radius = 30.1;
  const TriangleMesh open = with_hole(test::icosphere(4, radius), {0, 0, radius}, 8.0);
  ASSERT_GT(test::border_edges(open), 0);
  const FilledMesh filled = fill_holes(open, {.max_diameter = 25});
  EXPECT_EQ(filled.filled, 1);
  EXPECT_EQ(filled.left, 0);
  EXPECT_EQ(test::border_edges(filled.mesh), 0);
  // A flat lid would lie 1.1 mm below the top.
  const Eigen::VectorXd radii = filled.mesh.vertices.colwise().norm();
  EXPECT_LT((radii.array() - radius).abs().maxCoeff(), 0.1);
  EXPECT_GT(filled.mesh.vertices.cols(), open.vertices.cols());
}

TEST_F(HoleFilling, WhatWasThereKeepsItsPlaceAndOrder) {
  const TriangleMesh open = test::bumpy(4000, 0.25);
  const FilledMesh filled = fill_holes(open, {.max_diameter = 200});
  EXPECT_EQ(filled.mesh.vertices.leftCols(open.vertices.cols()), open.vertices);
  EXPECT_EQ(filled.mesh.triangles.leftCols(open.triangles.cols()), open.triangles);
}

TEST_F(HoleFilling, TellsItsProgressAndEndsWhenTold) {
  TriangleMesh open = with_hole(test::icosphere(3, 30), {0, 0, 30}, 8);
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(30, 0, 0), Eigen::Vector3d(0, -30, 0)})
    open = with_hole(open, at, 8);
  std::vector<std::pair<int, int>> seen;
  HoleFillingOptions options{
      .max_diameter = 40, .progress = [&](int done, int total) { seen.emplace_back(done, total); }};
  EXPECT_EQ(fill_holes(open, options).filled, 3);
  EXPECT_EQ(seen, (std::vector<std::pair<int, int>>{{1, 3}, {2, 3}, {3, 3}}));
  options.progress = [](int, int) { throw std::domain_error("stop"); };
  EXPECT_THROW((void)fill_holes(open, options), std::domain_error);
}

TEST_F(HoleFilling, OnlyHolesUpToTheSizeAreFilled) {
  // Holes of about 64 and 43 px radius in 640 px, 600 mm away: 110 and 70 mm wide; and the outline.
  const TriangleMesh open = test::bumpy(4000);
  EXPECT_EQ(fill_holes(open, {.max_diameter = 20}).filled, 0);
  EXPECT_EQ(fill_holes(open, {.max_diameter = 20}).left, 3);
  EXPECT_EQ(fill_holes(open, {.max_diameter = 200}).filled, 2);
  const FilledMesh closed = fill_holes(open, {.max_diameter = kInf});
  EXPECT_EQ(closed.filled, 3);
  EXPECT_EQ(test::border_edges(closed.mesh), 0);
}

TEST_F(HoleFilling, TheOutlineOfAFragmentIsNoHole) {
  const TriangleMesh open = with_hole(test::icosphere(3, 30), {0, 0, 30}, 8.0);
  // Beside it a single triangle, and a curved strip of six.
  TriangleMesh mesh = open;
  const auto vertices = open.vertices.cols();
  const auto triangles = open.triangles.cols();
  mesh.vertices.conservativeResize(3, vertices + 11);
  mesh.triangles.conservativeResize(3, triangles + 7);
  mesh.vertices.rightCols(11) << 50, 52, 50, 60, 60, 62, 62, 64, 64, 66, 66,  //
      0, 0, 2, 0, 2, 0, 2, 0, 2, 0, 2,                                        //
      0, 0, 0, 0, 0, 0.2, 0.2, 0.2, 0.2, 0, 0;
  const auto first = static_cast<int>(vertices);
  mesh.triangles.col(triangles) << first, first + 1, first + 2;
  for (int i = 0; i < 3; ++i) {
    const int corner = first + 3 + 2 * i;
    mesh.triangles.col(triangles + 1 + 2 * i) << corner, corner + 2, corner + 1;
    mesh.triangles.col(triangles + 2 + 2 * i) << corner + 1, corner + 2, corner + 3;
  }
  const FilledMesh filled = fill_holes(mesh, {.max_diameter = 25});
  EXPECT_EQ(filled.filled, 1);
  EXPECT_EQ(filled.left, 2);
  EXPECT_EQ(test::border_edges(filled.mesh), 3 + 8);
  for (const MeshDefect& defect : find_defects(filled.mesh))
    EXPECT_EQ(defect.kind, DefectKind::vertex_isolated);  // of the hole
}

TEST_F(HoleFilling, TheResultHasNoDefects) {
  for (const MeshDefect& defect :
       find_defects(fill_holes(test::bumpy(4000, 0.25), {.max_diameter = 200}).mesh)) {
    EXPECT_EQ(defect.kind, DefectKind::triangle_needle) << describe(defect);
  }
}

TEST_F(HoleFilling, AFlatHoleIsFilledFlat) {
  const TriangleMesh open = with_hole(test::flat_sheet(20, 20, 1.3), {13, 13, 0}, 5.0);
  const FilledMesh filled = fill_holes(open, {.max_diameter = 20});
  ASSERT_EQ(filled.filled, 1);
  EXPECT_LT(filled.mesh.vertices.row(2).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_F(HoleFilling, AScaleByAPowerOfTwoScalesTheResult) {
  const TriangleMesh open = with_hole(test::icosphere(3, 30.1), {0, 0, 30.1}, 8.0);
  const FilledMesh filled = fill_holes(open, {.max_diameter = 25});
  const FilledMesh scaled = fill_holes(test::scaled(open, 0.125), {.max_diameter = 25 * 0.125});
  ASSERT_EQ(scaled.mesh.triangles, filled.mesh.triangles);
  EXPECT_LT((scaled.mesh.vertices / 0.125 - filled.mesh.vertices).cwiseAbs().maxCoeff(), 1e-9);
}

/// In a build without CGAL too.
TEST(HoleFillingOptions, MustHaveADiameter) {
  const TriangleMesh sheet = test::flat_sheet(2, 2, 1);
  EXPECT_THROW((void)fill_holes(sheet, {}), InvalidInput);
  EXPECT_THROW((void)fill_holes(sheet, {.max_diameter = std::nan("")}), InvalidInput);
}

TEST_F(HoleFilling, RefusesAMeshThatIsNotManifold) {
  const TriangleMesh sheet = test::flat_sheet(2, 2, 1);
  TriangleMesh turned = sheet;
  turned.triangles.col(1).reverseInPlace();
  EXPECT_THROW((void)fill_holes(turned, {.max_diameter = 1}), InvalidInput);
  EXPECT_THROW((void)fill_holes({}, {.max_diameter = 1}), InvalidInput);
}

TEST_F(HoleFilling, PartsThatMeetInAClosedVertexAreRefused) {
  // Two tetrahedra with a common vertex 0; then the second one lacks a triangle.
  TriangleMesh mesh;
  mesh.vertices.resize(3, 7);
  mesh.vertices << 0, 1, 0, 0, -1, 0, 0,  //
      0, 0, 1, 0, 0, -1, 0,               //
      0, 0, 0, 1, 0, 0, -1;
  mesh.triangles.resize(3, 8);
  mesh.triangles << 0, 0, 0, 1, 0, 0, 0, 4,  //
      2, 3, 1, 2, 4, 5, 6, 6,                //
      1, 2, 3, 3, 5, 6, 4, 5;
  EXPECT_THROW((void)fill_holes(mesh, {.max_diameter = 5}), InvalidInput);
  mesh.triangles(Eigen::all, 4).swap(mesh.triangles(Eigen::all, 7));
  mesh.triangles.conservativeResize(3, 7);
  EXPECT_THROW((void)fill_holes(mesh, {.max_diameter = 5}), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
