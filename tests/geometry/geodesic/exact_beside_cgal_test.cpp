// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The exact distance compared with CGAL's, an independent implementation of another algorithm.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "cgal_shortest_paths.h"
#include "mesh_corpus.h"
#include "palpate/geometry/geodesic_distance.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

/// Effect on a distance of the perturbation that CGAL needs, relative to it and to the mean edge.
constexpr double kPerturbed = 10 * test::kCgalPerturbation;

TEST(ExactBesideCgal, DistancesAndLabelsAgree) {
  TriangleMesh star = test::icosphere(3, 10);
  std::mt19937 random(5);
  for (auto vertex : star.vertices.colwise()) {
    vertex *= std::uniform_real_distribution(0.1, 1.0)(random);
  }
  for (const TriangleMesh& mesh : {test::bumpy(2000, 0.25), test::bumpy(2000, 20), test::glove(9.0),
                                   test::closed_sheet(30, 20), star}) {
    std::uniform_int_distribution<int> any(0, static_cast<int>(mesh.triangles.cols()) - 1);
    const double edge =
        (mesh.vertices.col(mesh.triangles(0, 0)) - mesh.vertices.col(mesh.triangles(1, 0))).norm();
    for (const int count : {1, 12}) {
      std::vector<SurfacePoint> sources = {corner_point(any(random), 1)};
      while (static_cast<int>(sources.size()) < count) {
        sources.push_back({.triangle = any(random), .barycentric = {0.2, 0.3, 0.5}});
      }
      const GeodesicDistance ours =
          geodesic_distance(mesh, sources, {.method = GeodesicMethod::exact});
      const GeodesicDistance truth = test::cgal_geodesic_distance(mesh, sources);
      for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
        EXPECT_NEAR(ours.distance[v], truth.distance[v], kPerturbed * (truth.distance[v] + edge));
      }
      EXPECT_EQ(ours.label, truth.label);
    }
  }
}

}  // namespace
}  // namespace palpate::geometry
