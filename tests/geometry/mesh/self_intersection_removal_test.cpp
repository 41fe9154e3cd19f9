// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/self_intersection_removal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "cgal_availability.h"
#include "mesh_corpus.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_defects.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/self_intersections.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

constexpr double kSphereRadius = 30;

/// Moves one in `one_in` of the vertices by up to `distance` along each axis.
TriangleMesh with_noise(TriangleMesh mesh, int one_in, double distance, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-distance, distance);
  for (auto vertex : mesh.vertices.colwise()) {
    if (random() % static_cast<unsigned>(one_in) != 0) continue;
    for (double& coordinate : vertex) coordinate += uniform(random);
  }
  return mesh;
}

/// Describes the defects except for needles.
std::string unsound(const TriangleMesh& mesh) {
  std::string described;
  for (const MeshDefect& defect : find_all_defects(mesh))
    if (defect.kind != DefectKind::triangle_needle) described += describe(defect) + "; ";
  return described;
}

class SelfIntersectionRemovals : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::has_cgal()) GTEST_SKIP() << "the library was built without CGAL";
  }
};

TEST_F(SelfIntersectionRemovals, FoldsAndSpikesOfNoiseGoAndTheTopologyStays) {
  const TriangleMesh sphere = test::icosphere(4, kSphereRadius);
  const TriangleMesh open = test::bumpy(3000);
  for (const unsigned seed : {1U, 2U, 3U}) {
    for (const TriangleMesh& clean : {sphere, open}) {
      const double edge = mesh_shape(clean).mean_edge;
      for (const TriangleMesh& noisy :
           {with_noise(clean, 1, 0.7 * edge, seed), with_noise(clean, 50, 4 * edge, seed)}) {
        const SelfIntersectionRemoval removal = remove_self_intersections(noisy);
        EXPECT_GT(removal.found, 20);
        EXPECT_EQ(removal.left, 0);
        EXPECT_EQ(unsound(removal.mesh), "");
        EXPECT_EQ(test::border_edges(removal.mesh), test::border_edges(clean));
        EXPECT_EQ(euler_characteristic(removal.mesh), euler_characteristic(clean));
      }
    }
  }
}

TEST_F(SelfIntersectionRemovals, APatchIsNoFartherFromTheSurfaceThanTheNoiseWas) {
  const double noise = 1.6;
  const TriangleMesh noisy = with_noise(test::icosphere(4, kSphereRadius), 1, noise, 5);
  const SelfIntersectionRemoval removal = remove_self_intersections(noisy);
  const auto farthest = [](const TriangleMesh& mesh) {
    return (mesh.vertices.colwise().norm().array() - kSphereRadius).abs().maxCoeff();
  };
  EXPECT_EQ(removal.left, 0);
  EXPECT_LE(farthest(removal.mesh), farthest(noisy));
}

TEST_F(SelfIntersectionRemovals, WhatIsFarFromAnIntersectionStaysAndIsMappedToItsVertex) {
  // A tip is pushed back through the surface beside it.
  const TriangleMesh sphere = test::icosphere(3, kSphereRadius);
  const auto is_far = [&](Eigen::Index v) { return sphere.vertices(0, v) < -kSphereRadius / 4; };
  TriangleMesh mesh = sphere;
  Eigen::Index tip = 0;
  mesh.vertices.row(0).maxCoeff(&tip);
  mesh.vertices(0, tip) = -kSphereRadius / 2;
  mesh.vertices(1, tip) = kSphereRadius / 2;
  const Eigen::Vector3d about(kSphereRadius, 0, 0);
  for (auto vertex : mesh.vertices.colwise())
    if (vertex != mesh.vertices.col(tip) && (vertex - about).norm() < kSphereRadius / 3)
      vertex += Eigen::Vector3d(0, kSphereRadius / 2, 0);
  const SelfIntersectionRemoval removal = remove_self_intersections(mesh);
  ASSERT_GT(removal.found, 0);
  ASSERT_EQ(removal.source.size(), static_cast<std::size_t>(removal.mesh.vertices.cols()));
  std::vector<bool> found(static_cast<std::size_t>(mesh.vertices.cols()), false);
  for (std::size_t v = 0; v < removal.source.size(); ++v) {
    if (removal.source[v] < 0) continue;
    found[static_cast<std::size_t>(removal.source[v])] = true;
    if (!is_far(removal.source[v])) continue;
    EXPECT_EQ(removal.mesh.vertices.col(static_cast<Eigen::Index>(v)),
              mesh.vertices.col(removal.source[v]));
  }
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v)
    EXPECT_TRUE(found[static_cast<std::size_t>(v)] || !is_far(v));
}

TEST_F(SelfIntersectionRemovals, DistantPartsThatPassThroughEachOtherStayAndAreCounted) {
  const TriangleMesh sphere = test::icosphere(3, kSphereRadius);
  TriangleMesh two = sphere;
  two.vertices.conservativeResize(3, 2 * sphere.vertices.cols());
  two.vertices.rightCols(sphere.vertices.cols()) =
      sphere.vertices.colwise() + Eigen::Vector3d(40, 3, 1);
  two.triangles.conservativeResize(3, 2 * sphere.triangles.cols());
  two.triangles.rightCols(sphere.triangles.cols()) =
      sphere.triangles.array() + static_cast<int>(sphere.vertices.cols());
  const SelfIntersectionRemoval removal = remove_self_intersections(two);
  EXPECT_GT(removal.found, 50);
  EXPECT_EQ(removal.left, removal.found);
  EXPECT_EQ(removal.mesh.vertices, two.vertices);
  EXPECT_EQ(removal.mesh.triangles, two.triangles);
}

TEST_F(SelfIntersectionRemovals, AMeshWithoutAnyIsReturned) {
  const TriangleMesh mesh = test::bumpy(3000);
  const SelfIntersectionRemoval removal = remove_self_intersections(mesh);
  EXPECT_EQ(removal.found, 0);
  EXPECT_EQ(removal.mesh.vertices, mesh.vertices);
  EXPECT_EQ(removal.mesh.triangles, mesh.triangles);
  EXPECT_EQ(removal.source.back(), mesh.vertices.cols() - 1);
}

TEST_F(SelfIntersectionRemovals, TellsItsProgressAndEndsWhenTold) {
  const TriangleMesh noisy = with_noise(test::icosphere(3, kSphereRadius), 1, 3, 1);
  std::vector<int> seen;
  SelfIntersectionRemovalOptions options;
  options.progress = [&](int done, int total) {
    seen.push_back(done);
    EXPECT_EQ(total, static_cast<int>(intersecting_triangles(noisy).size()));
  };
  const SelfIntersectionRemoval removal = remove_self_intersections(noisy, options);
  ASSERT_GT(seen.size(), 5U);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_EQ(seen.back(), removal.found);
  options.progress = [](int, int) { throw std::domain_error("stop"); };
  EXPECT_THROW((void)remove_self_intersections(noisy, options), std::domain_error);
}

TEST_F(SelfIntersectionRemovals, AMeshThatIsNotManifoldIsRefused) {
  TriangleMesh mesh = test::icosphere(1, kSphereRadius);
  mesh.triangles.conservativeResize(3, mesh.triangles.cols() + 1);
  mesh.triangles.rightCols(1) = mesh.triangles.col(0);
  EXPECT_THROW((void)remove_self_intersections(mesh), InvalidInput);
}

TEST(SelfIntersectionRemovalWithoutCgal, IsRefusedInWords) {
  if (test::has_cgal()) GTEST_SKIP() << "the library was built with CGAL";
  EXPECT_THROW((void)remove_self_intersections(test::icosphere(1, kSphereRadius)), Unavailable);
}

}  // namespace
}  // namespace palpate::geometry
