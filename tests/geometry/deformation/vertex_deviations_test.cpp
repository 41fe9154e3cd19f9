// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "deformation/vertex_deviations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "mesh_corpus.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/nonrigid_registration.h"
#include "range_map_scene.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

constexpr int kSeenWidth = 192;      // pixels of 3 mm
constexpr double kDepthNoise = 0.3;  // mm

/// Range map of a surface, with other noise for each seed.
RangeMap seen(const TriangleMesh& surface, double noise, unsigned seed, double unit = 1) {
  RangeMap map = test::render(surface, test::bumpy_camera(kSeenWidth));
  test::add_noise(map, noise, seed);
  map.z *= static_cast<float>(unit);
  return map;
}

/// The surface, scaled about its middle.
TriangleMesh grown(const TriangleMesh& rest, const Vector3d& growth) {
  const Vector3d middle = rest.vertices.rowwise().mean();
  return test::deformed(rest, [&](const Vector3d& p) -> Vector3d {
    return middle + growth.cwiseProduct(p - middle);
  });
}

double median_where_seen(const DeformedSurface& found, const Eigen::VectorXd& values) {
  std::vector<double> of_seen;
  for (std::size_t v = 0; v < found.sight.size(); ++v)
    if (found.sight[v] == VertexSight::seen)
      of_seen.push_back(values[static_cast<Eigen::Index>(v)]);
  EXPECT_GT(of_seen.size(), found.sight.size() / 5);
  return error_statistics(of_seen).median;
}

TEST(VertexDeviations, AgreeWithTheErrorsOfManySequences) {
  const TriangleMesh rest = test::bumpy(12000);
  const DeformationGraph graph(rest, {.nodes = 250});
  const Eigen::Matrix3Xd normals = vertex_normals(rest);
  double across = 0, along = 0, stated_across = 0, stated_along = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    const double phase = 0.8 * seed;
    const TriangleMesh moved =
        grown(rest, Vector3d(1 + 0.02 * std::sin(phase), 1 + 0.02 * std::cos(phase), 1));
    const DeformedSurface found = register_deformed(graph, seen(moved, kDepthNoise, seed));
    for (Eigen::Index v = 0; v < rest.vertices.cols(); ++v) {
      if (found.sight[static_cast<std::size_t>(v)] != VertexSight::seen) continue;
      const Vector3d off = found.vertices.col(v) - moved.vertices.col(v);
      const double height = off.dot(normals.col(v));
      across += height * height;
      along += off.squaredNorm() - height * height;
      stated_across += std::pow(found.sigma_across[v], 2);
      stated_along += std::pow(found.sigma_along[v], 2);
    }
  }
  // With the noise of normals, the deviations also lose relief, and so are too large rather than
  // too small.
  constexpr double kLeast = 0.4, kMost = 1.5;
  EXPECT_GT(std::sqrt(across / stated_across), kLeast);
  EXPECT_LT(std::sqrt(across / stated_across), kMost);
  EXPECT_GT(std::sqrt(along / stated_along), kLeast);
  EXPECT_LT(std::sqrt(along / stated_along), kMost);
}

TEST(VertexDeviations, AreLargeAlongASurfaceThatMaySlideInItself) {
  TriangleMesh plate = test::bumpy(12000);
  for (auto vertex : plate.vertices.colwise()) vertex *= 700 / vertex.z();
  TriangleMesh ball = test::icosphere(5, 90);
  ball.vertices.row(2).array() += 700;
  const auto along = [](const TriangleMesh& rest, double noise) {
    const DeformationGraph graph(rest, {.nodes = 250});
    const DeformedSurface found = register_deformed(graph, seen(rest, noise, 3));
    return median_where_seen(found, found.sigma_along);
  };
  for (const double noise : {0.0, kDepthNoise}) {
    const double with_relief = along(test::bumpy(12000), noise);
    EXPECT_GT(along(plate, noise), 10 * with_relief) << noise;
    EXPECT_GT(along(ball, noise), 3 * with_relief) << noise;
  }
}

TEST(VertexDeviations, AreProportionalToTheNoise) {
  const TriangleMesh rest = test::bumpy(12000);
  const DeformationGraph graph(rest, {.nodes = 250});
  const auto across = [&](double noise) {
    const DeformedSurface found = register_deformed(graph, seen(rest, noise, 5));
    return median_where_seen(found, found.sigma_across);
  };
  EXPECT_NEAR(across(0.8) / across(0.4), 2, 0.3);
}

TEST(VertexDeviations, AreLengths) {
  constexpr double kUnit = 1 / 1024.0;  // exact
  TriangleMesh rest = test::bumpy(12000);
  const RangeMap map = seen(rest, kDepthNoise, 7), small = seen(rest, kDepthNoise, 7, kUnit);
  const DeformedSurface found = register_deformed(DeformationGraph(rest, {.nodes = 250}), map);
  rest.vertices *= kUnit;
  const DeformedSurface same = register_deformed(DeformationGraph(rest, {.nodes = 250}), small);
  constexpr double kRounding = 1e-6;
  EXPECT_TRUE(same.sigma_across.isApprox(kUnit * found.sigma_across, kRounding));
  EXPECT_TRUE(same.sigma_along.isApprox(kUnit * found.sigma_along, kRounding));
}

TEST(VertexDeviations, AreUnknownWhereNothingOfAPieceIsMeasured) {
  const TriangleMesh front = test::bumpy(3000);
  TriangleMesh aside = front;
  aside.vertices.row(0).array() += 10000;
  const TriangleMesh both = test::together(front, aside);
  const DeformedSurface found =
      register_deformed(DeformationGraph(both, {.nodes = 100}), seen(front, kDepthNoise, 9));
  for (Eigen::Index v = 0; v < both.vertices.cols(); ++v) {
    EXPECT_EQ(std::isfinite(found.sigma_across[v]), v < front.vertices.cols()) << v;
    EXPECT_EQ(std::isfinite(found.sigma_along[v]), v < front.vertices.cols()) << v;
  }
}

}  // namespace
}  // namespace palpate::geometry
