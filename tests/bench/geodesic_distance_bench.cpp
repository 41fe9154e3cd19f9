// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Fast marching beside Dijkstra along the edges, the heat method and the exact distance, and the
// exact distance beside CGAL's, on range maps. Every time includes what is built from the mesh.
// Errors are relative to exact distances, of the vertices more than two mean edges from the source.
#include "palpate/geometry/geodesic_distance.h"

#include <CGAL/Heat_method_3/Surface_mesh_geodesic_distances_3.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <random>
#include <tuple>
#include <vector>

#include "cgal_shortest_paths.h"
#include "mesh_corpus.h"
#include "paired.h"
#include "palpate/geometry/cgal_mesh.h"

namespace {

using palpate::geometry::GeodesicDistance;
using palpate::geometry::GeodesicMethod;
using palpate::geometry::SurfacePoint;
using palpate::geometry::TriangleMesh;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Each vertex's neighbours, once each, with the lengths of the edges.
struct Graph {
  struct Edge {
    double length;
    int to;
  };
  std::vector<int> first;
  std::vector<Edge> edges;
};

Graph edge_graph(const TriangleMesh& mesh) {
  check_mesh(mesh, "edge_graph");
  const auto vertex_count = static_cast<size_t>(mesh.vertices.cols());
  std::vector<int> begin(vertex_count + 1, 0);
  for (const int v : mesh.triangles.reshaped()) begin[static_cast<size_t>(v) + 1] += 2;
  for (size_t v = 0; v < vertex_count; ++v) begin[v + 1] += begin[v];
  std::vector<int> ends(static_cast<size_t>(begin.back()));
  std::vector<int> free(begin.begin(), begin.end() - 1);
  for (const auto& corners : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      int& at = free[static_cast<size_t>(corners[k])];
      ends[static_cast<size_t>(at++)] = corners[(k + 1) % 3];
      ends[static_cast<size_t>(at++)] = corners[(k + 2) % 3];
    }
  }
  Graph graph;
  graph.edges.reserve(ends.size() / 2 + vertex_count);
  graph.first.assign(1, 0);
  for (size_t v = 0; v < vertex_count; ++v) {
    const auto mine = static_cast<std::ptrdiff_t>(graph.edges.size());
    for (int i = begin[v]; i < begin[v + 1]; ++i) {
      const int to = ends[static_cast<size_t>(i)];
      const auto is_same = [to](const Graph::Edge& edge) { return edge.to == to; };
      if (std::any_of(graph.edges.begin() + mine, graph.edges.end(), is_same)) continue;
      const auto from = static_cast<Eigen::Index>(v);
      graph.edges.push_back({(mesh.vertices.col(from) - mesh.vertices.col(to)).norm(), to});
    }
    graph.first.push_back(static_cast<int>(graph.edges.size()));
  }
  return graph;
}

/// Shortest paths along the edges from the corners of the sources' triangles, with labels.
GeodesicDistance edge_dijkstra(const TriangleMesh& mesh, const std::vector<SurfacePoint>& sources) {
  const Graph graph = edge_graph(mesh);
  GeodesicDistance result{.distance = Eigen::VectorXd::Constant(mesh.vertices.cols(), kInfinity),
                          .label = Eigen::VectorXi::Constant(mesh.vertices.cols(), -1)};
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto arrive = [&](int vertex, double distance, int label) {
    if (!(distance < result.distance[vertex])) return;
    result.distance[vertex] = distance;
    result.label[vertex] = label;
    queue.emplace(distance, vertex);
  };
  for (size_t i = 0; i < sources.size(); ++i) {
    const Eigen::Vector3d from = position(mesh, sources[i]);
    for (const int corner : mesh.triangles.col(sources[i].triangle)) {
      arrive(corner, (mesh.vertices.col(corner) - from).norm(), static_cast<int>(i));
    }
  }
  while (!queue.empty()) {
    const auto [distance, v] = queue.top();
    queue.pop();
    if (distance > result.distance[v]) continue;
    for (int i = graph.first[static_cast<size_t>(v)]; i < graph.first[static_cast<size_t>(v) + 1];
         ++i) {
      const Graph::Edge& edge = graph.edges[static_cast<size_t>(i)];
      arrive(edge.to, distance + edge.length, result.label[v]);
    }
  }
  return result;
}

/// CGAL's heat method with intrinsic Delaunay triangulation, from one vertex.
GeodesicDistance heat(const TriangleMesh& mesh, int source) {
  using Point = CGAL::Simple_cartesian<double>::Point_3;
  using Surface = CGAL::Surface_mesh<Point>;
  const Surface surface = palpate::geometry::to_surface_mesh<Point>(mesh);
  std::vector<double> distances(surface.number_of_vertices(), kInfinity);
  CGAL::Heat_method_3::Surface_mesh_geodesic_distances_3<Surface,
                                                         CGAL::Heat_method_3::Intrinsic_Delaunay>
      method(surface);
  method.add_source(Surface::Vertex_index(static_cast<unsigned>(source)));
  method.estimate_geodesic_distances(CGAL::make_property_map(distances));
  return {.distance = Eigen::Map<const Eigen::VectorXd>(
              distances.data(), static_cast<Eigen::Index>(distances.size())),
          .label = {}};
}

constexpr int kGlove = 0;  ///< in place of a number of triangles

struct Case {
  TriangleMesh mesh;
  std::vector<SurfacePoint> sources;
};

/// \param percent_noise  of a mm
Case make_case(std::int64_t triangles, std::int64_t percent_noise, std::int64_t source_count) {
  Case made{.mesh = triangles == kGlove
                        ? palpate::geometry::test::glove()
                        : palpate::geometry::test::bumpy(static_cast<int>(triangles),
                                                         static_cast<double>(percent_noise) / 100),
            .sources = {}};
  std::mt19937 random(3);
  std::uniform_int_distribution<int> any(0, static_cast<int>(made.mesh.triangles.cols()) - 1);
  for (int i = 0; i < source_count; ++i) {
    // From a vertex, as the heat method needs it, or from inside faces.
    made.sources.push_back({.triangle = any(random),
                            .barycentric = source_count == 1 ? Eigen::Vector3d(1, 0, 0)
                                                             : Eigen::Vector3d(0.2, 0.3, 0.5)});
  }
  return made;
}

/// The exact answer and the seconds it took; found once for all benchmarks of a case.
struct Truth {
  GeodesicDistance geodesic;
  double seconds;
};
const Truth& truth_of(const benchmark::State& state, const Case& given) {
  static std::map<std::tuple<std::int64_t, std::int64_t, std::int64_t>, Truth> known;
  const auto [place, is_new] = known.try_emplace({state.range(0), state.range(1), state.range(2)});
  if (is_new) {
    Truth& truth = place->second;
    truth.seconds = palpate::bench::seconds([&] {
      truth.geodesic =
          geodesic_distance(given.mesh, given.sources, {.method = GeodesicMethod::exact});
    });
  }
  return place->second;
}

void count_errors(benchmark::State& state, const Case& given, const GeodesicDistance& measured) {
  const GeodesicDistance& exact = truth_of(state, given).geodesic;
  double edges = 0;
  for (const auto& corners : given.mesh.triangles.colwise()) {
    edges += (given.mesh.vertices.col(corners[0]) - given.mesh.vertices.col(corners[1])).norm();
  }
  const double near = 2 * edges / static_cast<double>(given.mesh.triangles.cols());
  double sum = 0, max = 0;
  int count = 0, mislabelled = 0;
  for (Eigen::Index v = 0; v < exact.distance.size(); ++v) {
    if (measured.label.size() > 0 && measured.label[v] != exact.label[v]) ++mislabelled;
    if (!(exact.distance[v] > near && exact.distance[v] < kInfinity)) continue;
    const double error = std::abs(measured.distance[v] / exact.distance[v] - 1);
    sum += error;
    max = std::max(max, error);
    ++count;
  }
  state.counters["mean_%"] = 100 * sum / count;
  state.counters["max_%"] = 100 * max;
  if (given.sources.size() > 1) {
    state.counters["labels_%"] = 100.0 * mislabelled / static_cast<double>(exact.distance.size());
  }
  state.counters["triangles"] = static_cast<double>(given.mesh.triangles.cols());
}

void fast_marching_against_dijkstra(benchmark::State& state) {
  const Case given = make_case(state.range(0), state.range(1), state.range(2));
  GeodesicDistance ours, peer;
  palpate::bench::run_paired(
      state, [&] { ours = geodesic_distance(given.mesh, given.sources); },
      [&] { peer = edge_dijkstra(given.mesh, given.sources); });
  count_errors(state, given, ours);
  // A path along the edges is never shorter than one across the faces, apart from the error of
  // marching.
  constexpr double kMarchingError = 0.03;  // relative
  if ((ours.distance.array() > (1 + kMarchingError) * peer.distance.array()).any()) {
    state.SkipWithError("fast marching is farther than the edges: the answers disagree");
  }
  const double exact_ms = 1e3 * truth_of(state, given).seconds;
  state.counters["exact_ms"] = exact_ms;
  state.counters["exact/ours"] = exact_ms / state.counters["ours_ms"].value;
}

void exact_against_cgal(benchmark::State& state) {
  const Case given = make_case(state.range(0), state.range(1), state.range(2));
  GeodesicDistance ours, peer;
  palpate::bench::run_paired(
      state,
      [&] {
        ours = geodesic_distance(given.mesh, given.sources, {.method = GeodesicMethod::exact});
      },
      [&] { peer = palpate::geometry::test::cgal_geodesic_distance(given.mesh, given.sources); });
  state.counters["triangles"] = static_cast<double>(given.mesh.triangles.cols());
  // CGAL misses the shortest path to a few vertices, never ours.
  constexpr double kPerturbed = 1e-7;  // relative
  if ((ours.distance.array() > (1 + kPerturbed) * peer.distance.array() + kPerturbed).any()) {
    state.SkipWithError("the exact distance is longer than CGAL's");
  }
}

void dijkstra(benchmark::State& state) {
  const Case given = make_case(state.range(0), state.range(1), state.range(2));
  GeodesicDistance found;
  for ([[maybe_unused]] auto _ : state) found = edge_dijkstra(given.mesh, given.sources);
  count_errors(state, given, found);
}

void heat_method(benchmark::State& state) {
  const Case given = make_case(state.range(0), state.range(1), 1);
  const int source = given.mesh.triangles(0, given.sources[0].triangle);
  GeodesicDistance found;
  for ([[maybe_unused]] auto _ : state) found = heat(given.mesh, source);
  count_errors(state, given, found);
}

void sizes(benchmark::internal::Benchmark* bench) {
  for (const int triangles : {3000, 30000, 300000}) bench->Args({triangles, 25, 1});
  bench->Unit(benchmark::kMillisecond);
}

void sizes_noises_and_sources(benchmark::internal::Benchmark* bench) {
  for (const int triangles : {3000, 30000, 100000, 300000}) {
    for (const int noise : {0, 25}) bench->Args({triangles, noise, 1});
  }
  for (const int triangles : {30000, 100000, 300000}) bench->Args({triangles, 25, 1000});
  bench->Args({kGlove, 0, 1})->Unit(benchmark::kMillisecond)->ArgNames({"N", "noise", "sources"});
}

BENCHMARK(fast_marching_against_dijkstra)->Apply(sizes_noises_and_sources);
BENCHMARK(exact_against_cgal)
    ->Args({3000, 25, 1})
    ->Args({30000, 0, 1})
    ->Args({30000, 25, 1})
    ->Args({100000, 25, 1})
    ->Args({kGlove, 0, 1})
    ->Args({30000, 25, 1000})
    ->Unit(benchmark::kMillisecond)
    ->ArgNames({"N", "noise", "sources"});
BENCHMARK(dijkstra)->Apply(sizes);
BENCHMARK(heat_method)->Apply(sizes)->Args({600000, 25, 1})->Iterations(1);

}  // namespace
