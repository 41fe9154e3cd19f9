// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Fast marching beside the exact distance and round holes; what else holds for it alone is in
// geodesic_distance_test.cpp.
#include <gtest/gtest.h>

#include <cmath>
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
  // The sheet is flat: all there is comes from the edges of the shadow.
  EXPECT_LT(errors.mean, 0.1 * kMeanError);
  EXPECT_LT(errors.max, 0.15 * kMaxError);
}

}  // namespace
}  // namespace palpate::geometry
