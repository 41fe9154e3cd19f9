// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Fast marching against Dijkstra along the edges, from one source, on a bumpy height field.
#include "palpate/geometry/geodesic_distance.h"

#include <cmath>
#include <limits>
#include <queue>
#include <vector>

#include "paired.h"

namespace {

using palpate::geometry::SurfacePoint;
using palpate::geometry::TriangleMesh;

TriangleMesh bumpy_surface(int side) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, side * side);
  mesh.triangles.resize(3, 2 * (side - 1) * (side - 1));
  int t = 0;
  for (int row = 0; row < side; ++row) {
    for (int col = 0; col < side; ++col) {
      const double s = static_cast<double>(col) / (side - 1),
                   r = static_cast<double>(row) / (side - 1);
      const int i = row * side + col;
      mesh.vertices.col(i) << 400 * s, 400 * r, 12 * std::sin(19 * s) * std::cos(16 * r);
      if (row == side - 1 || col == side - 1) continue;
      mesh.triangles.col(t++) << i, i + 1, i + side + 1;
      mesh.triangles.col(t++) << i, i + side + 1, i + side;
    }
  }
  return mesh;
}

/// The peer: shortest paths along the edges.
std::vector<double> edge_dijkstra(const TriangleMesh& mesh,
                                  const std::vector<std::vector<int>>& neighbors, int source) {
  std::vector<double> distance(neighbors.size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  distance[static_cast<std::size_t>(source)] = 0;
  queue.emplace(0, source);
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > distance[static_cast<std::size_t>(v)]) continue;
    for (const int n : neighbors[static_cast<std::size_t>(v)]) {
      const double through = d + (mesh.vertices.col(v) - mesh.vertices.col(n)).norm();
      if (through < distance[static_cast<std::size_t>(n)]) {
        distance[static_cast<std::size_t>(n)] = through;
        queue.emplace(through, n);
      }
    }
  }
  return distance;
}

void geodesic_distance_against_dijkstra(benchmark::State& state) {
  const TriangleMesh mesh = bumpy_surface(static_cast<int>(state.range(0)));
  std::vector<std::vector<int>> neighbors(static_cast<std::size_t>(mesh.vertices.cols()));
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const int a = mesh.triangles(i, t), b = mesh.triangles((i + 1) % 3, t);
      neighbors[static_cast<std::size_t>(a)].push_back(b);
      neighbors[static_cast<std::size_t>(b)].push_back(a);
    }
  }
  const SurfacePoint source{.triangle = 0, .barycentric = {1, 0, 0}};
  Eigen::VectorXd ours;
  std::vector<double> peer;
  palpate::bench::run_paired(
      state,
      [&] {
        ours = palpate::geometry::geodesic_distance(mesh, {&source, 1}).distance;
      },
      [&] { peer = edge_dijkstra(mesh, neighbors, mesh.triangles(0, 0)); });
  // A path along the edges is never shorter than one across the faces, but for the error of
  // marching.
  constexpr double kMarchingError = 0.015;  // relative
  for (Eigen::Index i = 0; i < ours.size(); ++i) {
    if (ours(i) > (1 + kMarchingError) * peer[static_cast<std::size_t>(i)]) {
      state.SkipWithError("fast marching is farther than the edges: the answers disagree");
    }
  }
  state.counters["triangles"] = static_cast<double>(mesh.triangles.cols());
}
BENCHMARK(geodesic_distance_against_dijkstra)->Arg(100)->Arg(388)->Unit(benchmark::kMillisecond);

}  // namespace
