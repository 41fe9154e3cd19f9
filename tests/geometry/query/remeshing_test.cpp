// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/remeshing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "mesh_corpus.h"
#include "not_finite.h"
#include "palpate/geometry/mesh_distance.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/self_intersections.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

constexpr double kRadiansPerDegree = std::numbers::pi / 180;

/// Share of the edges that are between the lengths at which edges are collapsed and split.
double share_in_range(const TriangleMesh& mesh, double length) {
  int in_range = 0;
  for (const auto& t : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      const double edge = (mesh.vertices.col(t[k]) - mesh.vertices.col(t[(k + 1) % 3])).norm();
      in_range += edge >= 0.8 * length && edge <= 4.0 / 3 * length ? 1 : 0;
    }
  }
  return in_range / static_cast<double>(mesh.triangles.size());
}

/// A box of squares, each of two triangles.
TriangleMesh box(double x, double y, double z) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 8);
  for (int v = 0; v < 8; ++v)
    mesh.vertices.col(v) << (v % 2 != 0 ? x : 0), (v / 2 % 2 != 0 ? y : 0), (v / 4 != 0 ? z : 0);
  mesh.triangles.resize(3, 12);
  mesh.triangles << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      3, 2, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,                //
      1, 3, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  return mesh;
}

struct Remeshed {
  const char* name;
  TriangleMesh mesh;
  double length;
};

TEST(Remeshing, MakesNearlyEquilateralTrianglesOfTheSameTopology) {
  for (const Remeshed& c : {Remeshed{"finer sphere", test::icosphere(3, 50), 4},
                            Remeshed{"coarser sphere", test::icosphere(4, 50), 8},
                            Remeshed{"finer range map", test::bumpy(1500, 0), 12},
                            Remeshed{"coarser range map", test::bumpy(4000, 0.25), 16},
                            Remeshed{"sheet", test::closed_sheet(40, 30), 2},
                            Remeshed{"torus", test::torus(40, 20, 20, 3), 1.1}}) {
    const Remeshing result = remesh(c.mesh, {.edge_length = c.length});
    EXPECT_TRUE(find_all_defects(result.mesh).empty()) << c.name;
    EXPECT_EQ(euler_characteristic(result.mesh), euler_characteristic(c.mesh)) << c.name;
    EXPECT_EQ(boundary_loops(result.mesh).size(), boundary_loops(c.mesh).size()) << c.name;
    const MeshShape shape = mesh_shape(result.mesh);
    EXPECT_GT(share_in_range(result.mesh, c.length), 0.93) << c.name;
    EXPECT_NEAR(shape.mean_edge, c.length, 0.15 * c.length) << c.name;
    EXPECT_GT(shape.median_smallest_angle, 48 * kRadiansPerDegree) << c.name;
    EXPECT_GT(shape.smallest_angle, 20 * kRadiansPerDegree) << c.name;
  }
}

TEST(Remeshing, PutsVerticesOntoTheSurfaceAndSaysWhere) {
  const TriangleMesh mesh = test::bumpy(4000, 0.25);
  const Remeshing result = remesh(mesh, {.edge_length = 10});
  std::set<int> border;
  for (const std::vector<int>& loop : boundary_loops(result.mesh))
    border.insert(loop.begin(), loop.end());
  ASSERT_EQ(result.places.size(), static_cast<size_t>(result.mesh.vertices.cols()));
  for (size_t v = 0; v < result.places.size(); ++v) {
    const Vector3d vertex = result.mesh.vertices.col(static_cast<Eigen::Index>(v));
    EXPECT_LE((position(mesh, result.places[v]) - vertex).norm(),
              border.contains(static_cast<int>(v)) ? 10 * kFeatureTolerance : 1e-9);
  }
}

TEST(Remeshing, OfASphereIsAsNearAsTheChordsOfItsEdges) {
  constexpr double kRadius = 50;
  const TriangleMesh sphere = test::icosphere(4, kRadius);
  // Distance of the middle of an equilateral triangle below a sphere through its corners.
  const auto below = [](double edge) { return edge * edge / 3 / (2 * kRadius); };
  for (const double length : {4.0, 10.0}) {
    const Remeshing result = remesh(sphere, {.edge_length = length});
    const double bound = below(4.0 / 3 * length) + below(mesh_shape(sphere).longest_edge);
    EXPECT_LT(hausdorff_distance(sphere, result.mesh).upper, 1.05 * bound);
    // Not more than the longer edges can cut off.
    EXPECT_NEAR(enclosed_volume(result.mesh) / enclosed_volume(sphere), 1, 3 * bound / kRadius);
  }
}

TEST(Remeshing, KeepsTheEdgesAndCornersOfABoxExactly) {
  const TriangleMesh block = box(30, 20, 10);
  for (const double length : {1.5, 4.0}) {
    const Remeshing result = remesh(block, {.edge_length = length});
    EXPECT_NEAR(enclosed_volume(result.mesh), 6000, 6000 * 1e-12);
    EXPECT_NEAR(surface_area(result.mesh), 2200, 2200 * 1e-12);
    EXPECT_LT(hausdorff_distance(block, result.mesh).upper, 1e-9);
    EXPECT_GT(share_in_range(result.mesh, length), 0.93);
    for (const auto& corner : block.vertices.colwise()) {
      EXPECT_EQ((result.mesh.vertices.colwise() - corner).colwise().norm().minCoeff(), 0);
    }
  }
  // And back: edges that were cut along straight lines are joined again.
  const TriangleMesh fine = remesh(block, {.edge_length = 1.5}).mesh;
  const Remeshing coarse = remesh(fine, {.edge_length = 6});
  EXPECT_NEAR(enclosed_volume(coarse.mesh), 6000, 6000 * 1e-12);
  EXPECT_GT(mesh_shape(coarse.mesh).shortest_edge, 0.4 * 6);
  // Without features the edges are rounded off.
  EXPECT_LT(
      enclosed_volume(remesh(block, {.edge_length = 4, .feature_angle = std::numbers::pi}).mesh),
      5990);
}

TEST(Remeshing, KeepsTheBorderOfASheetAndItsHole) {
  TriangleMesh sheet = test::flat_sheet(40, 30, 1);
  // Cut a jagged hole out of the middle.
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < sheet.triangles.cols(); ++t) {
    const Vector3d centre = position(sheet, {static_cast<int>(t), Vector3d::Constant(1.0 / 3)});
    if ((centre - Vector3d(20, 15, 0)).norm() > 6) kept.push_back(t);
  }
  sheet.triangles = Eigen::Matrix3Xi(sheet.triangles(Eigen::all, kept));
  const Remeshing result = remesh(sheet, {.edge_length = 2.5});
  EXPECT_NEAR(surface_area(result.mesh), surface_area(sheet), 1e-9);
  EXPECT_EQ(boundary_loops(result.mesh).size(), 2U);
  EXPECT_LT(result.mesh.triangles.cols(), sheet.triangles.cols() / 2);
}

TEST(Remeshing, StaysOnItsSideOfThinParts) {
  const TriangleMesh sheet = test::closed_sheet(40, 30, 2, 0.2);  // a tenth as thick as the edges
  const Remeshing result = remesh(sheet, {.edge_length = 2});
  EXPECT_NEAR(enclosed_volume(result.mesh), enclosed_volume(sheet), 0.02 * enclosed_volume(sheet));
  EXPECT_EQ(euler_characteristic(result.mesh), 2);
}

TEST(Remeshing, EndsOnTrianglesWithoutAreaAndNeedles) {
  TriangleMesh mesh = test::flat_sheet(12, 9, 1);
  mesh.vertices.row(0) *= 50;  // needles
  mesh.vertices.col(40) = (mesh.vertices.col(39) + mesh.vertices.col(41)) / 2;
  mesh.vertices.col(60) = mesh.vertices.col(61);  // no area
  const Remeshing result = remesh(mesh, {.edge_length = 3});
  EXPECT_GT(share_in_range(result.mesh, 3), 0.6);
  const TriangleMesh glove = test::glove(6);
  EXPECT_EQ(euler_characteristic(remesh(glove, {.edge_length = 5}).mesh), 2);
}

TEST(Remeshing, ScalesWithTheUnitOfLength) {
  const TriangleMesh mesh = test::bumpy(1500, 0.5);
  const Remeshing result = remesh(mesh, {.edge_length = 15});
  for (const double scale : {0x1p-12, 0x1p12}) {
    const Remeshing scaled = remesh(test::scaled(mesh, scale), {.edge_length = 15 * scale});
    ASSERT_EQ(scaled.mesh.triangles, result.mesh.triangles);
    EXPECT_EQ(scaled.mesh.vertices, scale * result.mesh.vertices);
  }
}

TEST(Remeshing, ReportsItsProgressAndEndsWhenToldTo) {
  const TriangleMesh mesh = test::icosphere(2, 10);
  std::vector<std::pair<int, int>> seen;
  (void)remesh(mesh, {.edge_length = 2,
                      .progress = [&](int done, int total) { seen.emplace_back(done, total); }});
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_EQ(seen.back().first, seen.back().second);
  EXPECT_THROW((void)remesh(mesh, {.edge_length = 2,
                                   .progress = [](int, int) { throw std::domain_error("stop"); }}),
               std::domain_error);
}

TEST(Remeshing, RefusesBadOptionsAndWhatWouldNotFit) {
  const TriangleMesh mesh = test::flat_sheet(10, 10, 1);
  const auto says = [&](const RemeshingOptions& options, const TriangleMesh& given) {
    return refusal([&] { return remesh(given, options); });
  };
  for (const double length : {0.0, -1.0, kNaN, kInf}) {
    EXPECT_NE(says({.edge_length = length}, mesh).find("edge_length"), std::string::npos);
  }
  EXPECT_NE(says({.edge_length = 1, .feature_angle = 4}, mesh).find("feature_angle"),
            std::string::npos);
  EXPECT_EQ(says({}, mesh), "RemeshingOptions::edge_length must be given");
  // 100 mm^2 in triangles of sqrt(3)/4 * 0.01^2 mm^2 are 2.31e6; with 1e6 of them the edges have
  // sqrt(2.31) * 0.01 mm.
  const std::string large = says({.edge_length = 0.01, .max_triangles = 1'000'000}, mesh);
  EXPECT_NE(large.find("2.31e+06"), std::string::npos) << large;
  EXPECT_NE(large.find("at least 0.0152 mm"), std::string::npos) << large;
  // Hardly any area, but long edges.
  TriangleMesh needle = mesh;
  needle.vertices.row(0) *= 1e-9;
  EXPECT_NE(says({.edge_length = 1e-3, .max_triangles = 5000}, needle).find("5000 triangles"),
            std::string::npos);
  TriangleMesh bow;
  bow.vertices.resize(3, 5);
  bow.vertices << 0, 1, 1, -1, -1, 0, 1, -1, 1, -1, 0, 0, 0, 0, 0;
  bow.triangles.resize(3, 2);
  bow.triangles << 0, 0, 2, 3, 1, 4;
  const std::string fans = says({.edge_length = 1}, bow);
  EXPECT_NE(fans.find("vertex 0"), std::string::npos) << fans;
  EXPECT_NE(fans.find("repair"), std::string::npos) << fans;
  TriangleMesh broken = mesh;
  broken.vertices(2, 7) = kNaN;
  EXPECT_NE(says({.edge_length = 1}, broken).find("vertex 7"), std::string::npos);
}

}  // namespace
}  // namespace palpate::geometry
