// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Decimation to a verified tolerance against meshoptimizer alone and CGAL's edge collapse, both at
// the number of triangles that ours came to: time, and the distance that is really left.
#include "palpate/geometry/decimation.h"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "mesh_corpus.h"
#include "paired.h"
#include "palpate/geometry/mesh_distance.h"

namespace {

namespace geometry = palpate::geometry;
using geometry::TriangleMesh;

struct Peer {
  TriangleMesh mesh;
  double estimate = 0;  ///< [mm] error that it states; NaN if it states none
};

/// meshoptimizer to a number of triangles, on the coordinates as they are, in float.
Peer meshoptimizer_alone(const TriangleMesh& mesh, Eigen::Index triangles) {
  const Eigen::Vector3d centre = mesh.vertices.rowwise().mean();
  const Eigen::Matrix3Xf positions = (mesh.vertices.colwise() - centre).cast<float>();
  const auto count = static_cast<std::size_t>(positions.cols());
  const std::vector<unsigned> indices(mesh.triangles.data(),
                                      mesh.triangles.data() + mesh.triangles.size());
  std::vector<unsigned> simplified(indices.size());
  float error = 0;
  constexpr std::size_t kStride = 3 * sizeof(float);
  simplified.resize(meshopt_simplify(simplified.data(), indices.data(), indices.size(),
                                     positions.data(), count, kStride,
                                     static_cast<std::size_t>(3 * triangles), 1e6F, 0, &error));
  Peer peer;
  peer.mesh.vertices = mesh.vertices;
  peer.mesh.triangles.resize(3, static_cast<Eigen::Index>(simplified.size() / 3));
  std::copy(simplified.begin(), simplified.end(), peer.mesh.triangles.data());
  peer.estimate = static_cast<double>(error) *
                  static_cast<double>(meshopt_simplifyScale(positions.data(), count, kStride));
  return peer;
}

/// CGAL's default: Lindstrom and Turk's memoryless cost and placement.
Peer cgal_edge_collapse(const TriangleMesh& mesh, Eigen::Index triangles) {
  using Surface = CGAL::Surface_mesh<CGAL::Simple_cartesian<double>::Point_3>;
  namespace simplification = CGAL::Surface_mesh_simplification;
  Surface surface;
  for (const auto& v : mesh.vertices.colwise()) surface.add_vertex({v.x(), v.y(), v.z()});
  for (const auto& t : mesh.triangles.colwise()) {
    surface.add_face(Surface::Vertex_index(static_cast<unsigned>(t[0])),
                     Surface::Vertex_index(static_cast<unsigned>(t[1])),
                     Surface::Vertex_index(static_cast<unsigned>(t[2])));
  }
  // It counts edges, three for two triangles.
  simplification::edge_collapse(surface, simplification::Count_stop_predicate<Surface>(
                                             static_cast<std::size_t>(3 * triangles / 2)));
  surface.collect_garbage();
  Peer peer{.mesh = {}, .estimate = std::numeric_limits<double>::quiet_NaN()};
  peer.mesh.vertices.resize(3, surface.number_of_vertices());
  for (const auto v : surface.vertices()) {
    const auto& p = surface.point(v);
    peer.mesh.vertices.col(static_cast<Eigen::Index>(v.idx())) << p.x(), p.y(), p.z();
  }
  peer.mesh.triangles.resize(3, surface.number_of_faces());
  for (const auto f : surface.faces()) {
    const auto triangle = static_cast<Eigen::Index>(f.idx());
    int k = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f))) {
      peer.mesh.triangles(k++, triangle) = static_cast<int>(v);
    }
  }
  return peer;
}

/// Arguments: triangles of the range map, tolerance and noise in micrometres.
void against(benchmark::State& state, auto&& make_peer) {
  const TriangleMesh mesh = geometry::test::bumpy(static_cast<int>(state.range(0)),
                                                  1e-3 * static_cast<double>(state.range(2)));
  const double tolerance = 1e-3 * static_cast<double>(state.range(1));
  geometry::Decimation ours = geometry::decimate(mesh, {.tolerance = tolerance});
  // A mesh returned unchanged is at distance 0, which is found up to rounding.
  const double rounding = 1e-12 * geometry::bounding_diagonal(mesh);
  if (!(geometry::hausdorff_distance(mesh, ours.mesh).lower <= ours.distance + rounding) ||
      !(ours.distance <= tolerance)) {
    state.SkipWithError("the bound does not hold");
    return;
  }
  Peer peer;
  palpate::bench::run_paired(
      state, [&] { ours = geometry::decimate(mesh, {.tolerance = tolerance}); },
      [&] { peer = make_peer(mesh, ours.mesh.triangles.cols()); });
  const geometry::HausdorffDistance left = geometry::hausdorff_distance(mesh, peer.mesh);
  state.counters["triangles"] = static_cast<double>(ours.mesh.triangles.cols());
  state.counters["ours_mm"] = ours.distance;
  state.counters["tries"] = ours.tries;
  state.counters["peer_triangles"] = static_cast<double>(peer.mesh.triangles.cols());
  state.counters["peer_mm"] = left.upper;
  state.counters["peer_says_mm"] = peer.estimate;
}

void against_meshoptimizer(benchmark::State& state) { against(state, meshoptimizer_alone); }
void against_cgal(benchmark::State& state) { against(state, cgal_edge_collapse); }

void distance_of_large_meshes(benchmark::State& state) {
  const TriangleMesh a = geometry::test::bumpy(300000, 0.25);
  const TriangleMesh b = geometry::test::bumpy(50000);
  for ([[maybe_unused]] auto _ : state)
    benchmark::DoNotOptimize(geometry::hausdorff_distance(a, b));
}

BENCHMARK(against_meshoptimizer)
    ->ArgNames({"triangles", "um", "noise_um"})
    ->ArgsProduct({{300000}, {50, 100, 200, 500, 1000, 2000}, {0, 250}})
    ->Iterations(1)
    ->Unit(benchmark::kSecond);
BENCHMARK(against_cgal)
    ->ArgNames({"triangles", "um", "noise_um"})
    ->ArgsProduct({{300000}, {500, 2000}, {0, 250}})
    ->Iterations(1)
    ->Unit(benchmark::kSecond);
BENCHMARK(distance_of_large_meshes)->Iterations(3)->Unit(benchmark::kSecond);

}  // namespace
