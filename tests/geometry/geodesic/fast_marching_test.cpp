// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Fast marching beside the exact distance and round holes; what else holds for it alone is in
// geodesic_distance_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "geodesic/geodesic_testing.h"
#include "mesh_corpus.h"
#include "not_finite.h"
#include "palpate/error.h"
#include "palpate/geometry/geodesic_distance.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

using test::kMaxError;
using test::kMeanError;

/// The exact answer, or nothing in a build without CGAL.
std::optional<GeodesicDistance> exact_or_nothing(const TriangleMesh& mesh,
                                                 const std::vector<SurfacePoint>& sources) {
  try {
    return geodesic_distance(mesh, sources, {.method = GeodesicMethod::exact});
  } catch (const Unavailable&) {
    return std::nullopt;
  }
}

TEST(FastMarching, OnRangeMapsIsNearTheExactOne) {
  for (const double noise : {0.0, 0.25}) {
    const TriangleMesh mesh = test::bumpy(8000, noise);
    for (const SurfacePoint& source : {corner_point(3000, 1), SurfacePoint{777, {0.5, 0.5, 0}},
                                       SurfacePoint{6100, {0.2, 0.3, 0.5}}}) {
      const auto truth = exact_or_nothing(mesh, {source});
      if (!truth) GTEST_SKIP() << "no CGAL";
      const test::RelativeErrors errors = test::relative_errors(
          geodesic_distance(mesh, std::vector{source}).distance, truth->distance, 20);
      // Coarse for these waves: twice what finer meshes have.
      EXPECT_LT(errors.mean, 2 * kMeanError);
      EXPECT_LT(errors.max, 2 * kMaxError);
    }
  }
}

TEST(FastMarching, IsNearTheExactOneInNeedlesOfAGlove) {
  const TriangleMesh glove = test::glove(4.0);
  const SurfacePoint source{100, {0.2, 0.3, 0.5}};
  const auto truth = exact_or_nothing(glove, {source});
  if (!truth) GTEST_SKIP() << "no CGAL";
  const test::RelativeErrors errors = test::relative_errors(
      geodesic_distance(glove, std::vector{source}).distance, truth->distance, 8);
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
  const auto truth = exact_or_nothing(mesh, sources);
  if (!truth) GTEST_SKIP() << "no CGAL";
  const GeodesicDistance geodesic = geodesic_distance(mesh, sources);
  const auto different = (geodesic.label.array() != truth->label.array()).count();
  EXPECT_LT(static_cast<double>(different), 0.015 * static_cast<double>(mesh.vertices.cols()));
}

/// A square plate with a square hole in its middle third.
TriangleMesh plate_with_hole(int cells, double spacing) {
  TriangleMesh plate = test::flat_sheet(3 * cells, 3 * cells, spacing);
  const auto in_hole = [&](const Eigen::Vector3i& t) {
    const Vector3d centre =
        (plate.vertices.col(t[0]) + plate.vertices.col(t[1]) + plate.vertices.col(t[2])) / 3;
    const Vector3d cell = centre / (cells * spacing);
    return cell.x() > 1 && cell.x() < 2 && cell.y() > 1 && cell.y() < 2;
  };
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < plate.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = plate.triangles.col(t);
    if (!in_hole(corners)) plate.triangles.col(kept++) = corners;
  }
  plate.triangles.conservativeResize(3, kept);
  return plate;
}

TEST(FastMarching, GoesRoundAHole) {
  constexpr int kCells = 10;
  constexpr double kSpacing = 0.7;
  const TriangleMesh plate = plate_with_hole(kCells, kSpacing);
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

/// Whether the straight line from p to q in the plane does not pass through the box.
bool sees(const Vector3d& p, const Vector3d& q, const Eigen::AlignedBox2d& box) {
  double enter = 0, leave = 1;
  for (int axis = 0; axis < 2; ++axis) {
    const double step = q[axis] - p[axis];
    const double low = box.min()[axis] - p[axis];
    const double high = box.max()[axis] - p[axis];
    if (step == 0 && (low >= 0 || high <= 0)) return true;
    if (step == 0) continue;
    enter = std::max(enter, std::min(low / step, high / step));
    leave = std::min(leave, std::max(low / step, high / step));
  }
  return enter >= leave;
}

TEST(FastMarching, InTheShadowOfAHoleIsThatRoundItsCorners) {
  constexpr int kCells = 14;
  constexpr double kSpacing = 0.7;
  const TriangleMesh plate = plate_with_hole(kCells, kSpacing);
  const SurfacePoint source = corner_point(0, 0);
  const Vector3d from = position(plate, source);
  const double side = kCells * kSpacing;
  constexpr double kTouch = 1e-9;  // mm; a way along the hole is free
  const Eigen::AlignedBox2d hole(Eigen::Vector2d::Constant(side + kTouch),
                                 Eigen::Vector2d::Constant(2 * side - kTouch));
  // The source is in a corner of the plate, and sees these two of the hole.
  std::vector<std::pair<Vector3d, double>> starts = {{from, 0}};
  for (const Vector3d& corner : {Vector3d(side, 2 * side, 0), Vector3d(2 * side, side, 0)}) {
    starts.emplace_back(corner, (corner - from).norm());
  }
  Eigen::VectorXd truth = Eigen::VectorXd::Constant(plate.vertices.cols(), kInf);
  for (Eigen::Index v = 0; v < truth.size(); ++v) {
    for (const auto& [start, distance] : starts) {
      const Vector3d to = plate.vertices.col(v);
      if (sees(start, to, hole)) truth[v] = std::min(truth[v], distance + (to - start).norm());
    }
  }
  Eigen::VectorXd measured = geodesic_distance(plate, std::vector{source}).distance;
  for (Eigen::Index v = 0; v < truth.size(); ++v) {
    // Vertices inside the hole are in no triangle.
    if (measured[v] == kInf) measured[v] = truth[v] = 0;
  }
  const test::RelativeErrors errors = test::relative_errors(measured, truth, 2 * kSpacing);
  // The sheet is flat: all there is comes from the edges of the shadow.
  EXPECT_LT(errors.mean, 0.1 * kMeanError);
  EXPECT_LT(errors.max, 0.15 * kMaxError);
}

}  // namespace
}  // namespace palpate::geometry
