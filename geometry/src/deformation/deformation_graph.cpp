// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/deformation_graph.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <queue>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/numbers.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"

namespace palpate::geometry {
namespace {

constexpr int kInfluences = DeformationGraph::kInfluences;

/// Smoothing as in SmoothingOptions: rounds, lambda and the pass band. Waves shorter than some ten
/// vertices are taken for noise.
constexpr int kSmoothings = 20;
constexpr double kShrink = 0.5;
constexpr double kPassBand = 0.1;
/// On coarser meshes, nodes follow such waves.
constexpr double kLeastVerticesPerNode = 8;

/// The edges at each vertex, with their lengths.
class EdgeLists {
 public:
  explicit EdgeLists(const TriangleMesh& mesh)
      : first_(static_cast<std::size_t>(mesh.vertices.cols()) + 1, 0),
        at_border_(static_cast<std::size_t>(mesh.vertices.cols()), 0) {
    std::vector<std::pair<int, int>> edges;
    edges.reserve(static_cast<std::size_t>(2 * mesh.triangles.size()));
    for (const auto& corners : mesh.triangles.colwise()) {
      for (int k = 0; k < 3; ++k) {
        edges.emplace_back(corners[k], corners[(k + 1) % 3]);
        edges.emplace_back(corners[(k + 1) % 3], corners[k]);
      }
    }
    std::ranges::sort(edges);
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const auto [from, to] = edges[e];
      if (e > 0 && edges[e] == edges[e - 1]) continue;
      if (e + 1 == edges.size() || edges[e] != edges[e + 1])
        at_border_[static_cast<std::size_t>(from)] = 1;
      ++first_[static_cast<std::size_t>(from) + 1];
      ends_.push_back({to, (mesh.vertices.col(to) - mesh.vertices.col(from)).norm()});
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
  }

  struct End {
    int vertex;
    double length;
  };
  [[nodiscard]] std::span<const End> at(int vertex) const {
    const auto v = static_cast<std::size_t>(vertex);
    return std::span(ends_).subspan(first_[v], first_[v + 1] - first_[v]);
  }
  [[nodiscard]] bool is_loose(int vertex) const { return at(vertex).empty(); }
  /// Returns true if an edge of the vertex belongs to one triangle only.
  [[nodiscard]] bool is_at_border(int vertex) const {
    return at_border_[static_cast<std::size_t>(vertex)] != 0;
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<char> at_border_;
  std::vector<End> ends_;
};

/// A path to a vertex. The shortest comes first; the other members make the order unique.
struct Way {
  double length;
  int vertex;
  int node;
  bool operator>(const Way& other) const {
    return std::tie(length, node, vertex) > std::tie(other.length, other.node, other.vertex);
  }
};
using Ways = std::priority_queue<Way, std::vector<Way>, std::greater<>>;

/// Farthest-point sampling: each new node is the vertex farthest from all previous nodes; vertices
/// that no node can reach come first. Returns vertices.
std::vector<int> choose_nodes(const EdgeLists& edges, Eigen::Index vertex_count, int wanted) {
  std::vector<double> distance(static_cast<std::size_t>(vertex_count), kInfinity);
  const auto at = [&](int v) -> double& { return distance[static_cast<std::size_t>(v)]; };
  // The farthest vertex. Outdated entries are put back with their true distance.
  std::priority_queue<std::pair<double, int>> farthest;
  for (int v = static_cast<int>(vertex_count) - 1; v >= 0; --v) {
    if (!edges.is_loose(v)) farthest.emplace(kInfinity, -v);  // the lowest index first among equals
  }
  std::vector<int> nodes;
  while (!farthest.empty()) {
    const auto [known, negative] = farthest.top();
    const int node = -negative;
    farthest.pop();
    if (at(node) < known) {
      if (at(node) > 0) farthest.emplace(at(node), negative);
      continue;
    }
    if (static_cast<int>(nodes.size()) >= wanted && known < kInfinity) break;
    nodes.push_back(node);
    at(node) = 0;
    Ways ways;
    ways.push({0, node, 0});
    while (!ways.empty()) {
      const Way way = ways.top();
      ways.pop();
      if (way.length > at(way.vertex)) continue;
      for (const auto& [vertex, length] : edges.at(way.vertex)) {
        const double through = way.length + length;
        if (through >= at(vertex)) continue;
        at(vertex) = through;
        ways.push({through, vertex, 0});
      }
    }
  }
  return nodes;
}

/// The nodes nearest to a vertex, nearest first: those that move it and the next one.
struct NearestNodes {
  std::array<double, kInfluences + 1> distance;
  std::array<int, kInfluences + 1> node;
  int count = 0;
  [[nodiscard]] bool has(int wanted) const {
    return std::find(node.begin(), node.begin() + count, wanted) != node.begin() + count;
  }
};

/// Dijkstra's algorithm from all nodes at once; a vertex passes on only its first few arrivals.
std::vector<NearestNodes> nearest_nodes(const EdgeLists& edges, Eigen::Index vertex_count,
                                        const std::vector<int>& nodes) {
  std::vector<NearestNodes> nearest(static_cast<std::size_t>(vertex_count));
  Ways ways;
  for (int i = 0; i < static_cast<int>(nodes.size()); ++i) {
    ways.push({0, nodes[static_cast<std::size_t>(i)], i});
  }
  const auto wants = [&](int vertex, int node) {
    const NearestNodes& here = nearest[static_cast<std::size_t>(vertex)];
    return here.count <= kInfluences && !here.has(node);
  };
  while (!ways.empty()) {
    const Way way = ways.top();
    ways.pop();
    if (!wants(way.vertex, way.node)) continue;
    NearestNodes& here = nearest[static_cast<std::size_t>(way.vertex)];
    here.distance[static_cast<std::size_t>(here.count)] = way.length;
    here.node[static_cast<std::size_t>(here.count++)] = way.node;
    for (const auto& [vertex, length] : edges.at(way.vertex)) {
      if (wants(vertex, way.node)) ways.push({way.length + length, vertex, way.node});
    }
  }
  return nearest;
}

/// w = (1 - d / d_last)^2, where d_last is the distance of the first node without influence (Sumner
/// et al., eq. 5). If the piece of surface has fewer nodes, d_last is twice the largest distance.
void weigh(const NearestNodes& nearest, DeformationGraph::Influences::ColXpr influences,
           DeformationGraph::Weights::ColXpr weights) {
  const int count = std::min(nearest.count, kInfluences);
  const double last = nearest.count > kInfluences
                          ? nearest.distance[kInfluences]
                          : 2 * nearest.distance[static_cast<std::size_t>(count - 1)];
  std::array<std::pair<int, double>, kInfluences> of_nodes;
  double sum = 0;
  for (int k = 0; k < kInfluences; ++k) {
    const auto i = static_cast<std::size_t>(std::min(k, count - 1));
    double weight = 0;
    if (k < count) {
      const double fraction = last > 0 ? 1 - nearest.distance[i] / last : 1;
      weight = fraction * fraction;
    }
    of_nodes[static_cast<std::size_t>(k)] = {nearest.node[i], weight};
    sum += weight;
  }
  if (!(sum > 0)) {  // all nodes are equally far from the vertex
    for (int k = 0; k < count; ++k) of_nodes[static_cast<std::size_t>(k)].second = 1;
    sum = count;
  }
  std::ranges::sort(of_nodes);
  for (int k = 0; k < kInfluences; ++k) {
    influences[k] = of_nodes[static_cast<std::size_t>(k)].first;
    weights[k] = of_nodes[static_cast<std::size_t>(k)].second / sum;
  }
}

Eigen::Matrix2Xi node_pairs(const DeformationGraph::Influences& influences,
                            const DeformationGraph::Weights& weights) {
  std::vector<std::pair<int, int>> pairs;
  std::pair<int, int> last{-1, -1};
  for (Eigen::Index v = 0; v < influences.cols(); ++v) {
    for (int i = 0; i < kInfluences; ++i) {
      for (int j = i + 1; j < kInfluences; ++j) {
        if (weights(i, v) == 0 || weights(j, v) == 0) continue;
        const std::pair<int, int> pair{influences(i, v), influences(j, v)};
        if (pair != last) pairs.push_back(pair);
        last = pair;
      }
    }
  }
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  Eigen::Matrix2Xi edges(2, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t e = 0; e < pairs.size(); ++e) {
    edges.col(static_cast<Eigen::Index>(e)) << pairs[e].first, pairs[e].second;
  }
  return edges;
}

/// The vertices without the noise of single ones, by Taubin's filter; those at the border stay.
/// `smooth` works on manifold meshes only.
Eigen::Matrix3Xd smoothed(const TriangleMesh& mesh, const EdgeLists& edge_lists,
                          Eigen::Index node_count) {
  const double vertices_per_node =
      static_cast<double>(mesh.vertices.cols()) / static_cast<double>(node_count);
  Eigen::Matrix3Xd even = mesh.vertices;
  if (vertices_per_node < kLeastVerticesPerNode) return even;
  const auto move_to_mean = [&](const Eigen::Matrix3Xd& from, double factor) {
    Eigen::Matrix3Xd moved = from;
    parallel_for(from.cols(), [&](Eigen::Index v) {
      const std::span<const EdgeLists::End> ends = edge_lists.at(static_cast<int>(v));
      if (ends.empty() || edge_lists.is_at_border(static_cast<int>(v))) return;
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      for (const EdgeLists::End& end : ends)
        mean += from.col(end.vertex) / static_cast<double>(ends.size());
      moved.col(v) += factor * (mean - from.col(v));
    });
    return moved;
  };
  for (int i = 0; i < kSmoothings; ++i)
    even = move_to_mean(move_to_mean(even, kShrink), 1 / (kPassBand - 1 / kShrink));
  return even;
}

}  // namespace

DeformationGraph::DeformationGraph(TriangleMesh mesh, const DeformationGraphOptions& options)
    : mesh_(std::move(mesh)) {
  require("DeformationGraphOptions::nodes", options.nodes, at_least(1));
  check_mesh(mesh_, "DeformationGraph");
  normals_ = vertex_normals(mesh_);
  const EdgeLists edge_lists(mesh_);
  const Eigen::Index vertex_count = mesh_.vertices.cols();
  const std::vector<int> node_vertices = choose_nodes(edge_lists, vertex_count, options.nodes);
  smooth_vertices_ = smoothed(mesh_, edge_lists, static_cast<Eigen::Index>(node_vertices.size()));
  nodes_ = smooth_vertices_(Eigen::all, node_vertices);

  const std::vector<NearestNodes> nearest = nearest_nodes(edge_lists, vertex_count, node_vertices);
  influences_.resize(kInfluences, vertex_count);
  weights_.resize(kInfluences, vertex_count);
  for (Eigen::Index v = 0; v < vertex_count; ++v) {
    if (edge_lists.is_loose(static_cast<int>(v))) {
      Eigen::Index node = 0;
      (nodes_.colwise() - mesh_.vertices.col(v)).colwise().squaredNorm().minCoeff(&node);
      influences_.col(v).setConstant(static_cast<int>(node));
      weights_.col(v) << 1, Eigen::Vector<double, kInfluences - 1>::Zero();
    } else {
      weigh(nearest[static_cast<std::size_t>(v)], influences_.col(v), weights_.col(v));
    }
  }
  edges_ = node_pairs(influences_, weights_);
  for (const auto& edge : edges_.colwise()) {
    spacing_ += (nodes_.col(edge[1]) - nodes_.col(edge[0])).norm();
  }
  spacing_ =
      edges_.cols() > 0 ? spacing_ / static_cast<double>(edges_.cols()) : bounding_diagonal(mesh_);
}

Eigen::Matrix3Xd deformed_vertices(const DeformationGraph& graph,
                                   std::span<const Eigen::Isometry3d> node_motions) {
  if (node_motions.size() != static_cast<std::size_t>(graph.nodes().cols())) {
    throw InvalidInput("deformed_vertices: " + std::to_string(node_motions.size()) +
                       " node motions were given, the graph has " +
                       std::to_string(graph.nodes().cols()) + " nodes; pass one for each");
  }
  Eigen::Matrix3Xd vertices(3, graph.mesh().vertices.cols());
  parallel_for(vertices.cols(), [&](Eigen::Index v) {
    const Eigen::Vector3d rest = graph.mesh().vertices.col(v);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int k = 0; k < kInfluences; ++k) {
      const auto node = static_cast<std::size_t>(graph.influences()(k, v));
      sum += graph.weights()(k, v) * (node_motions[node] * rest);
    }
    vertices.col(v) = sum;
  });
  return vertices;
}

}  // namespace palpate::geometry
