// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Fast marching beside the exact distance; what holds for it alone is in
// geodesic_distance_test.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "mesh_corpus.h"
#include "palpate/error.h"
#include "palpate/geometry/geodesic_distance.h"

namespace palpate::geometry {
namespace {

/// What the header promises of finely sampled range maps; relative to the distance.
constexpr double kMeanError = 0.0025;
constexpr double kMaxError = 0.015;

/// Errors relative to true distances, of the vertices further from the source than `near`.
struct Errors {
  double mean = 0;
  double max = 0;
};
Errors compare(const Eigen::VectorXd& measured, const Eigen::VectorXd& truth, double near) {
  Errors errors;
  int count = 0;
  for (Eigen::Index v = 0; v < truth.size(); ++v) {
    if (truth[v] <= near) continue;
    const double error = std::abs(measured[v] - truth[v]) / truth[v];
    errors.max = std::max(errors.max, error);
    errors.mean += error;
    ++count;
  }
  errors.mean /= count;
  return errors;
}

/// The exact answer, or nothing in a build without CGAL.
std::optional<GeodesicDistance> exact(const TriangleMesh& mesh,
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
    for (const SurfacePoint& source :
         {SurfacePoint{3000, {0, 1, 0}}, SurfacePoint{777, {0.5, 0.5, 0}},
          SurfacePoint{6100, {0.2, 0.3, 0.5}}}) {
      const auto truth = exact(mesh, {source});
      if (!truth) GTEST_SKIP() << "no CGAL";
      const Errors errors =
          compare(geodesic_distance(mesh, std::vector{source}).distance, truth->distance, 20);
      // Coarse for these waves: twice what finer meshes have.
      EXPECT_LT(errors.mean, 2 * kMeanError);
      EXPECT_LT(errors.max, 2 * kMaxError);
    }
  }
}

TEST(FastMarching, IsNearTheExactOneInNeedlesOfAGlove) {
  const TriangleMesh glove = test::glove(4.0);
  const SurfacePoint source{100, {0.2, 0.3, 0.5}};
  const auto truth = exact(glove, {source});
  if (!truth) GTEST_SKIP() << "no CGAL";
  const Errors errors =
      compare(geodesic_distance(glove, std::vector{source}).distance, truth->distance, 8);
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
  const auto truth = exact(mesh, sources);
  if (!truth) GTEST_SKIP() << "no CGAL";
  const GeodesicDistance geodesic = geodesic_distance(mesh, sources);
  const auto different = (geodesic.label.array() != truth->label.array()).count();
  EXPECT_LT(static_cast<double>(different), 0.015 * static_cast<double>(mesh.vertices.cols()));
}

}  // namespace
}  // namespace palpate::geometry
