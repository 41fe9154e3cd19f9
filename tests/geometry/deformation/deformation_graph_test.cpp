// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/deformation_graph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "file_testing.h"
#include "mesh_corpus.h"
#include "palpate/core/error.h"
#include "palpate/geometry/geodesic_distance.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int kInfluences = DeformationGraph::kInfluences;

/// The vertex on which each node stands, as a place on the mesh.
std::vector<SurfacePoint> node_places(const DeformationGraph& graph) {
  const TriangleMesh& mesh = graph.mesh();
  const std::vector<SurfacePoint> vertices = vertex_points(mesh);
  std::vector<SurfacePoint> places;
  for (const auto& node : graph.nodes().colwise()) {
    Eigen::Index v = 0;
    while (graph.smooth_vertices().col(v) != node) ++v;
    places.push_back(vertices[static_cast<size_t>(v)]);
  }
  return places;
}

double weight_of(const DeformationGraph& graph, Eigen::Index vertex, int node) {
  double weight = 0;
  for (int k = 0; k < kInfluences; ++k) {
    if (graph.influences()(k, vertex) == node) weight += graph.weights()(k, vertex);
  }
  return weight;
}

TEST(DeformationGraph, WeightsAreAPartitionAndNodesMoveTheirOwnPlace) {
  for (const TriangleMesh& mesh : {test::bumpy(3000), test::glove(4.1), test::icosphere(3, 31.7)}) {
    const DeformationGraph graph(mesh, {.nodes = 60});
    EXPECT_EQ(graph.nodes().cols(), 60);
    EXPECT_GE(graph.weights().minCoeff(), 0);
    EXPECT_LT((graph.weights().colwise().sum().array() - 1).abs().maxCoeff(), 1e-14);
    EXPECT_GE(graph.influences().minCoeff(), 0);
    EXPECT_LT(graph.influences().maxCoeff(), 60);
    for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
      for (int k = 0; k < kInfluences; ++k) {
        const int node = graph.influences()(k, v);
        if (mesh.vertices.col(v) != graph.nodes().col(node)) continue;
        for (int other = 0; other < kInfluences; ++other) {
          EXPECT_LE(graph.weights()(other, v), graph.weights()(k, v));
        }
      }
    }
  }
}

TEST(DeformationGraph, AllNodesTogetherMoveTheMeshRigidly) {
  const DeformationGraph graph(test::glove(4.1), {.nodes = 80});
  const Isometry3d T = Eigen::Translation3d(31.1, -7.3, 12.9) *
                       Eigen::AngleAxisd(1.1, Vector3d(0.2, -0.7, 0.4).normalized());
  const std::vector<Isometry3d> motions(80, T);
  constexpr double kRounding = 1e-12;  // of sums of values near 100
  EXPECT_LT((deformed_vertices(graph, motions) - T * graph.mesh().vertices).norm(),
            kRounding * graph.mesh().vertices.norm());
  EXPECT_THROWS_MESSAGE(static_cast<void>(deformed_vertices(graph, std::span(motions).first(79))),
                        InvalidInput, "79 node motions were given, the graph has 80");
}

TEST(DeformationGraph, SmoothVerticesHaveLessNoiseAndTheSameShape) {
  const double radius = 50, roughness = 0.3;  // mm
  const TriangleMesh sphere = test::icosphere(5, radius);
  TriangleMesh noisy = sphere;
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, roughness);
  for (auto vertex : noisy.vertices.colwise()) vertex *= 1 + normal(random) / radius;
  const auto radii_of = [&](const Eigen::Matrix3Xd& vertices) {
    return Eigen::ArrayXd(vertices.colwise().norm().transpose().array() - radius);
  };
  const Eigen::ArrayXd left = radii_of(DeformationGraph(noisy, {.nodes = 200}).smooth_vertices());
  EXPECT_LT(std::sqrt(left.square().mean()), roughness / 3);
  EXPECT_LT(radii_of(DeformationGraph(sphere, {.nodes = 200}).smooth_vertices()).abs().maxCoeff(),
            roughness / 10);
  // With this many nodes the graph follows anything.
  const TriangleMesh coarse = test::icosphere(2, radius);
  EXPECT_EQ(DeformationGraph(coarse, {.nodes = 40}).smooth_vertices(), coarse.vertices);
}

/// A way along edges is at most this many times as long as the straight one on these meshes.
constexpr double kDetour = 1.35;

TEST(DeformationGraph, NodesAreSpreadAlongTheSurfaceAndAFingerDoesNotMoveItsNeighbour) {
  const DeformationGraph graph(test::glove(4.1), {.nodes = 70});
  const TriangleMesh& mesh = graph.mesh();
  const std::vector<SurfacePoint> places = node_places(graph);
  const double covered = geodesic_distance(mesh, places).distance.maxCoeff();
  long nearer_in_space = 0;
  for (size_t n = 0; n < places.size(); ++n) {
    const GeodesicDistance from = geodesic_distance(mesh, {&places[n], 1});
    // No two nodes are nearer than the farthest vertex is from all of them.
    for (size_t other = 0; other < n; ++other) {
      const int vertex =
          mesh.triangles.col(places[other].triangle).dot(places[other].barycentric.cast<int>());
      EXPECT_GT(from.distance[vertex] * kDetour, covered);
    }
    const auto node = static_cast<int>(n);
    for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
      const double straight = (mesh.vertices.col(v) - graph.nodes().col(node)).norm();
      if (weight_of(graph, v, node) > 0) {
        EXPECT_LT(from.distance[v], 2 * kDetour * graph.spacing());
      } else if (straight < graph.spacing() && from.distance[v] > 3 * straight) {
        ++nearer_in_space;
      }
    }
  }
  EXPECT_GT(nearer_in_space, 20);  // the glove has places where it matters
}

TEST(DeformationGraph, ANodeGainsInfluenceGradually) {
  const DeformationGraph graph(test::flat_sheet(60, 60, 1.1), {.nodes = 40});
  // Nodes are 11 mm apart: one edge of 1.1 mm inside the reach of a node its weight is small,
  // except at the few places that are equally far from four nodes.
  double sum = 0;
  long count = 0;
  for (const auto& corners : graph.mesh().triangles.colwise()) {
    for (int node = 0; node < 40; ++node) {
      if (weight_of(graph, corners[0], node) > 0) continue;
      const double gained = weight_of(graph, corners[1], node);
      sum += gained;
      count += gained > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(count, 1000);
  EXPECT_LT(sum / static_cast<double>(count), 0.1);
}

TEST(DeformationGraph, EveryPieceHasANodeAndALooseVertexFollows) {
  TriangleMesh mesh = test::flat_sheet(3, 3, 2.3);
  const Eigen::Index side = mesh.vertices.cols();
  mesh.vertices.conservativeResize(3, 2 * side + 1);
  mesh.vertices.middleCols(side, side) =
      mesh.vertices.leftCols(side).colwise() + Vector3d(50, 0, 0);
  mesh.vertices.col(2 * side) << 60, 3, 0;
  const Eigen::Index triangles = mesh.triangles.cols();
  mesh.triangles.conservativeResize(3, 2 * triangles);
  mesh.triangles.rightCols(triangles) =
      mesh.triangles.leftCols(triangles).array() + static_cast<int>(side);
  const DeformationGraph graph(mesh, {.nodes = 1});
  ASSERT_EQ(graph.nodes().cols(), 2);
  EXPECT_EQ(graph.edges().cols(), 0);
  std::vector<Isometry3d> motions(2, Isometry3d::Identity());
  motions[graph.nodes()(0, 0) > 40 ? 0 : 1].translation().z() = 5;
  const Eigen::Matrix3Xd moved = deformed_vertices(graph, motions);
  for (Eigen::Index v = 0; v <= 2 * side; ++v) EXPECT_EQ(moved(2, v), v < side ? 0 : 5);
}

TEST(DeformationGraph, HasNoMoreNodesThanVertices) {
  const TriangleMesh mesh = test::flat_sheet(2, 2, 1.0);
  const DeformationGraph graph(mesh, {.nodes = 100});
  EXPECT_EQ(graph.nodes().cols(), 9);
}

TEST(DeformationGraph, DoesNotDependOnTheUnitOfLength) {
  const DeformationGraph graph(test::glove(4.1), {.nodes = 80});
  for (const double scale : {0x1p-20, 0x1p20}) {
    const DeformationGraph other(test::scaled(test::glove(4.1), scale), {.nodes = 80});
    EXPECT_EQ(other.influences(), graph.influences());
    EXPECT_EQ(other.weights(), graph.weights());
    EXPECT_EQ(other.nodes(), graph.nodes() * scale);
  }
}

TEST(DeformationGraph, RefusesBadMeshesAndOptions) {
  const auto refuse = [](const TriangleMesh& mesh, int nodes, const char* words) {
    EXPECT_THROWS_MESSAGE(DeformationGraph(mesh, {.nodes = nodes}), InvalidInput, words);
  };
  TriangleMesh mesh = test::flat_sheet(2, 2, 1.0);
  refuse(mesh, 0, "nodes is 0; it must be >= 1");
  refuse({}, 5, "no triangles");
  mesh.vertices(1, 4) = std::numeric_limits<double>::quiet_NaN();
  refuse(mesh, 5, "vertex 4 is not finite");
}

}  // namespace
}  // namespace palpate::geometry
