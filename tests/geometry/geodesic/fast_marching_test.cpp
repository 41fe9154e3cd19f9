// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Fast marching compared with the exact distance and round holes; its other tests are in
// geodesic_distance_test.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "geodesic/geodesic_testing.h"
#include "mesh_corpus.h"
#include "palpate/geometry/geodesic_distance.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

using test::kMaxError;
using test::kMeanError;

GeodesicDistance true_distances(const TriangleMesh& mesh,
                                const std::vector<SurfacePoint>& sources) {
  return geodesic_distance(mesh, sources, {.method = GeodesicMethod::exact});
}

TEST(FastMarching, OnRangeMapsIsNearTheExactOne) {
  for (const double noise : {0.0, 0.25}) {
    const TriangleMesh mesh = test::bumpy(8000, noise);
    for (const SurfacePoint& source : {corner_point(3000, 1), SurfacePoint{777, {0.5, 0.5, 0}},
                                       SurfacePoint{6100, {0.2, 0.3, 0.5}}}) {
      const GeodesicDistance truth = true_distances(mesh, {source});
      const test::RelativeErrors errors = test::relative_errors(
          geodesic_distance(mesh, std::vector{source}).distance, truth.distance, 20);
      // Coarse for these waves: twice what finer meshes have.
      EXPECT_LT(errors.mean, 2 * kMeanError);
      EXPECT_LT(errors.max, 2 * kMaxError);
    }
  }
}

TEST(FastMarching, IsNearTheExactOneInNeedlesOfAGlove) {
  const TriangleMesh glove = test::glove(4.0);
  const SurfacePoint source{100, {0.2, 0.3, 0.5}};
  const GeodesicDistance truth = true_distances(glove, {source});
  const test::RelativeErrors errors = test::relative_errors(
      geodesic_distance(glove, std::vector{source}).distance, truth.distance, 8);
  EXPECT_LT(errors.mean, 2 * kMeanError);
  // Where the wave meets itself behind a finger it may be some percent too short.
  EXPECT_LT(errors.max, 4 * kMaxError);
}

TEST(FastMarching, LabelsOnARangeMapAreNearlyTheExactOnes) {
  const TriangleMesh mesh = test::bumpy(8000, 0.25);
  std::mt19937 random(11);
  std::uniform_int_distribution<int> any(0, static_cast<int>(mesh.triangles.cols()) - 1);
  std::vector<SurfacePoint> sources;
  for (int i = 0; i < 100; ++i) {
    sources.push_back({.triangle = any(random), .barycentric = {0.2, 0.3, 0.5}});
  }
  const GeodesicDistance truth = true_distances(mesh, sources);
  const GeodesicDistance geodesic = geodesic_distance(mesh, sources);
  const auto different = (geodesic.label.array() != truth.label.array()).count();
  EXPECT_LT(static_cast<double>(different), 0.015 * static_cast<double>(mesh.vertices.cols()));
}

TEST(FastMarching, GoesRoundAHole) {
  constexpr int kCells = 10;
  constexpr double kSpacing = 0.7;
  const TriangleMesh plate = test::plate_with_hole(kCells, kSpacing);
  // From the middle of the left border to the middle of the right one, past the hole's corners.
  const int row = 3 * kCells + 1;
  const int left = row * (3 * kCells / 2);
  const int right = left + 3 * kCells;
  int triangle = 0;
  while ((plate.triangles.col(triangle).array() != left).all()) ++triangle;
  const Vector3d barycentric =
      (plate.triangles.col(triangle).array() == left).cast<double>().matrix();
  const double side = kCells * kSpacing;
  const double truth = side + 2 * std::hypot(side, side / 2);
  const GeodesicDistance geodesic =
      geodesic_distance(plate, std::vector<SurfacePoint>{{triangle, barycentric}});
  EXPECT_NEAR(geodesic.distance[right], truth, kMaxError * truth);
  EXPECT_GE(geodesic.distance[right], truth * (1 - test::kWayRounding));
}

TEST(FastMarching, InTheShadowOfAHoleIsThatRoundItsCorners) {
  constexpr int kCells = 14;
  constexpr double kSpacing = 0.7;
  const TriangleMesh plate = test::plate_with_hole(kCells, kSpacing);
  const SurfacePoint source = corner_point(0, 0);
  const test::RelativeErrors errors =
      test::relative_errors(geodesic_distance(plate, std::vector{source}).distance,
                            test::distances_around_hole(plate, kCells, kSpacing), 2 * kSpacing);
  // The sheet is flat: all errors come from the edges of the shadow.
  EXPECT_LT(errors.mean, 0.1 * kMeanError);
  EXPECT_LT(errors.max, 0.15 * kMaxError);
}

/// Flat sheets that share one side, at equal angles about it. The first vertices are those of that
/// side, which is along y.
TriangleMesh book(int sheets, int cols, int rows) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, (1 + sheets * cols) * (rows + 1));
  mesh.triangles.resize(3, 2 * sheets * cols * rows);
  const auto vertex = [&](int sheet, int col, int row) {
    return (col == 0 ? 0 : 1 + sheet * cols + col - 1) * (rows + 1) + row;
  };
  Eigen::Index triangle = 0;
  for (int sheet = 0; sheet < sheets; ++sheet) {
    const double angle = 2 * std::numbers::pi * sheet / sheets;
    const Vector3d outwards(std::cos(angle), 0, std::sin(angle));
    for (int col = 0; col <= cols; ++col) {
      for (int row = 0; row <= rows; ++row) {
        const double aside = row == 0 || row == rows ? 0 : 0.2 * std::sin(3.0 * col);
        mesh.vertices.col(vertex(sheet, col, row)) =
            col * outwards + (row + aside) * Vector3d::UnitY();
        if (col == cols || row == rows) continue;
        const int right = vertex(sheet, col + 1, row), above = vertex(sheet, col + 1, row + 1);
        mesh.triangles.col(triangle++) << vertex(sheet, col, row), right, above;
        mesh.triangles.col(triangle++) << vertex(sheet, col, row), above,
            vertex(sheet, col, row + 1);
      }
    }
  }
  return mesh;
}

TEST(FastMarching, OnABookIsTheStraightWayOnItsTwoOpenPages) {
  constexpr int kCols = 9, kRows = 14;
  for (const int sheets : {3, 5}) {
    const TriangleMesh mesh = book(sheets, kCols, kRows);
    for (const int triangle : {3, 100, 170, 251}) {  // on the first sheet
      const SurfacePoint source{.triangle = triangle, .barycentric = {0.2, 0.3, 0.5}};
      const Vector3d from = position(mesh, source);  // on the half-plane of positive x
      const GeodesicDistance geodesic = geodesic_distance(mesh, std::vector{source});
      for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
        const Vector3d to = mesh.vertices.col(v);
        const bool same_sheet = v < (1 + kCols) * (kRows + 1);
        const double aside = std::hypot(to.x(), to.z());
        const double truth =
            std::hypot(same_sheet ? from.x() - aside : from.x() + aside, from.y() - to.y());
        EXPECT_NEAR(geodesic.distance[v], truth, test::kWayRounding * 100) << sheets << ' ' << v;
      }
    }
  }
}

TEST(FastMarching, TrianglesThatAreThereTwiceChangeNothing) {
  const TriangleMesh mesh = test::bumpy(3000, 0.25);
  std::mt19937 random(9);
  std::vector<int> twice;  // from single ones to large parts
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    if (random() % 20 == 0 || t > 0.7 * static_cast<double>(mesh.triangles.cols()))
      twice.push_back(t);
  }
  TriangleMesh repeated = mesh;
  repeated.triangles.resize(3, mesh.triangles.cols() + static_cast<Eigen::Index>(twice.size()));
  repeated.triangles << mesh.triangles, mesh.triangles(Eigen::all, twice);
  for (const int triangle : {7, 901, 1777, 2600}) {
    const std::vector<SurfacePoint> source = {{triangle, {0.2, 0.3, 0.5}}};
    // A wave that passes a triangle twice is rounded in the same way, but may take another of two
    // ways whose lengths are equal to kWorthPassingOn.
    EXPECT_LT(test::relative_errors(geodesic_distance(repeated, source).distance,
                                    geodesic_distance(mesh, source).distance, 0)
                  .max,
              1e-9);
  }
}

}  // namespace
}  // namespace palpate::geometry
