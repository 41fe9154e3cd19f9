// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/smoothing.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <numeric>
#include <utility>
#include <vector>

#include "palpate/core/idle_fields.h"
#include "palpate/core/parallel_for.h"
#include "palpate/geometry/mesh_topology.h"

namespace palpate::geometry {
namespace {

// Vertices per parallel task.
constexpr Eigen::Index kVerticesPerTask = 4096;

/// The vertices that attract each vertex, grouped by vertex.
struct Neighbors {
  std::vector<int> start;  ///< of each vertex, and the end
  std::vector<int> vertex;
};

Neighbors list_neighbors(const TriangleMesh& mesh, bool keep_border) {
  const Eigen::Matrix3Xi opposite = opposite_half_edges(mesh);
  const auto from = [&](int h) { return mesh.triangles(h % 3, h / 3); };
  const auto to = [&](int h) { return mesh.triangles((h + 1) % 3, h / 3); };
  const auto at_border = [&](int h) { return opposite(h % 3, h / 3) < 0; };
  std::vector<bool> border(static_cast<std::size_t>(mesh.vertices.cols()), false);
  for (int h = 0; h < opposite.size(); ++h) {
    if (at_border(h)) border[static_cast<std::size_t>(from(h))] = true;
  }
  // Every edge that leaves an inner vertex is one of its outgoing half-edges.
  const auto visit_pairs = [&](const auto& visit) {
    for (int h = 0; h < opposite.size(); ++h) {
      if (!border[static_cast<std::size_t>(from(h))]) {
        visit(from(h), to(h));
      }
      if (at_border(h) && !keep_border) {
        visit(from(h), to(h));
        visit(to(h), from(h));
      }
    }
  };
  Neighbors neighbors;
  neighbors.start.assign(static_cast<std::size_t>(mesh.vertices.cols()) + 1, 0);
  visit_pairs([&](int vertex, int) { ++neighbors.start[static_cast<std::size_t>(vertex) + 1]; });
  std::partial_sum(neighbors.start.begin(), neighbors.start.end(), neighbors.start.begin());
  neighbors.vertex.resize(static_cast<std::size_t>(neighbors.start.back()));
  std::vector<int> place = neighbors.start;
  visit_pairs([&](int vertex, int other) {
    neighbors.vertex[static_cast<std::size_t>(place[static_cast<std::size_t>(vertex)]++)] = other;
  });
  return neighbors;
}

/// x + factor (mean of the neighbours - x) for every vertex.
void move_to_mean(const Neighbors& neighbors, const Eigen::Matrix3Xd& x, double factor,
                  Eigen::Matrix3Xd& moved) {
  parallel_ranges(x.cols(), kVerticesPerTask, [&](Eigen::Index begin, Eigen::Index end) {
    for (Eigen::Index i = begin; i < end; ++i) {
      const int first = neighbors.start[static_cast<std::size_t>(i)];
      const int last = neighbors.start[static_cast<std::size_t>(i) + 1];
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (int k = first; k < last; ++k)
        sum += x.col(neighbors.vertex[static_cast<std::size_t>(k)]) - x.col(i);
      moved.col(i) = x.col(i);
      if (last > first) moved.col(i) += factor / (last - first) * sum;
    }
  });
}

}  // namespace

void visit(SmoothingOptions& options, FieldVisitor& visitor) {
  /// A surface is smooth over its whole width long before.
  constexpr int kMostIterations = 1000;
  visitor.begin("SmoothingOptions");
  visitor.whole({.name = "iterations",
                 .description = "Iterations of smoothing without shrinking (Taubin); 20 remove "
                                "most noise",
                 .option = "smooth"},
                options.iterations, at_least(0).at_most(kMostIterations));
  constexpr bool kExpert = true;
  visitor.real(
      {"pass_band", "Waves of a lower frequency are not smoothed; the highest of a mesh has 2", "",
       kExpert},
      options.pass_band, above(0).below(1));
  visitor.flag({"keep_border", "Keep the border where it is; otherwise it is smoothed along itself",
                "", kExpert},
               options.keep_border);
}

TriangleMesh smooth(const TriangleMesh& mesh, const SmoothingOptions& options) {
  static_cast<void>(in_range(options));
  if (options.iterations == 0) refuse_idle(options, "iterations", {"pass_band", "keep_border"});
  const Neighbors neighbors = list_neighbors(mesh, options.keep_border);
  const double mu = 1 / (options.pass_band - 1 / kSmoothingStep);
  TriangleMesh result = mesh;
  Eigen::Matrix3Xd shrunk(3, mesh.vertices.cols());
  for (int i = 0; i < options.iterations; ++i) {
    move_to_mean(neighbors, result.vertices, kSmoothingStep, shrunk);
    move_to_mean(neighbors, shrunk, mu, result.vertices);
  }
  return result;
}

}  // namespace palpate::geometry
