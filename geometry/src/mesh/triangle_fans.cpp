// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "mesh/triangle_fans.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/numbers.h"

namespace palpate::geometry {
namespace {

/// Squared sine assigned to a corner of a triangle without area, so that the signs of its products
/// still indicate where its apex is: the square of the rounding of a double.
constexpr double kLeastSquaredSine = 1e-32;

/// A path bends at a vertex of the border iff the angle of the surface there exceeds pi by this
/// many radians, so that noise on a straight border does not count as a corner.
constexpr double kCornerAngle = 0.1;

void find_turns(TriangleFans& fans) {
  const size_t vertex_count = fans.longest.size();
  fans.turns.assign(vertex_count, 0);
  for (size_t v = 0; v < vertex_count; ++v) {
    const int corner_count = fans.first_corner[v + 1] - fans.first_corner[v];
    // Inside, the triangles close.
    if (fans.first_neighbour[v + 1] - fans.first_neighbour[v] == corner_count) continue;
    double angle = 0;
    for (int i = fans.first_corner[v]; i < fans.first_corner[v + 1]; ++i) {
      const TriangleFans::Corner& corner = fans.corners[static_cast<size_t>(i)];
      angle += std::atan2(std::sqrt(corner.cross), corner.dot);
    }
    fans.turns[v] = angle > std::numbers::pi + kCornerAngle ? 1 : 0;
  }
}

}  // namespace

std::vector<int> half_edges_by_vertex(const TriangleMesh& mesh, std::vector<int>& first) {
  first.assign(static_cast<size_t>(mesh.vertices.cols()) + 1, 0);
  for (const int v : mesh.triangles.reshaped()) ++first[static_cast<size_t>(v) + 1];
  for (size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
  std::vector<int> free(first.begin(), first.end() - 1);
  std::vector<int> half_edges(static_cast<size_t>(mesh.triangles.size()));
  int h = 0;
  for (const int v : mesh.triangles.reshaped()) {
    half_edges[static_cast<size_t>(free[static_cast<size_t>(v)]++)] = h++;
  }
  return half_edges;
}

TriangleFans triangle_fans(const TriangleMesh& mesh) {
  const auto vertex_count = static_cast<size_t>(mesh.vertices.cols());
  TriangleFans fans;
  const std::vector<int> half_edges = half_edges_by_vertex(mesh, fans.first_corner);
  fans.corners.reserve(half_edges.size());
  fans.neighbours.reserve(half_edges.size() + vertex_count);
  fans.first_neighbour.assign(1, 0);
  std::vector<int> place(vertex_count, kNone);  // among all neighbours
  for (size_t v = 0; v < vertex_count; ++v) {
    const Eigen::Vector3d apex = mesh.vertices.col(static_cast<Eigen::Index>(v));
    const int begin = fans.first_neighbour.back();
    const auto neighbour = [&](int vertex, const Eigen::Vector3d& edge) {
      int& at = place[static_cast<size_t>(vertex)];
      if (at < begin) {
        at = static_cast<int>(fans.neighbours.size());
        const double squared = edge.squaredNorm();
        fans.neighbours.push_back({.vertex = vertex,
                                   .length = std::sqrt(squared),
                                   .squared = squared,
                                   .inverse = 1 / squared});
      }
      return at - begin;
    };
    for (int i = fans.first_corner[v]; i < fans.first_corner[v + 1]; ++i) {
      const int h = half_edges[static_cast<size_t>(i)];
      const int next = mesh.triangles((h + 1) % 3, h / 3);
      const int last = mesh.triangles((h + 2) % 3, h / 3);
      const Eigen::Vector3d to_next = mesh.vertices.col(next) - apex;
      const Eigen::Vector3d to_last = mesh.vertices.col(last) - apex;
      const double least = kLeastSquaredSine * to_next.squaredNorm() * to_last.squaredNorm();
      fans.corners.push_back({.next = neighbour(next, to_next),
                              .last = neighbour(last, to_last),
                              .dot = to_next.dot(to_last),
                              .cross = std::max(to_next.cross(to_last).squaredNorm(), least)});
    }
    fans.first_neighbour.push_back(static_cast<int>(fans.neighbours.size()));
  }
  fans.longest.assign(vertex_count, 0);
  for (size_t v = 0; v < vertex_count; ++v) {
    double longest = 0;
    for (int i = fans.first_neighbour[v]; i < fans.first_neighbour[v + 1]; ++i) {
      longest = std::max(longest, fans.neighbours[static_cast<size_t>(i)].length);
    }
    fans.longest[v] = longest;
  }
  find_turns(fans);
  return fans;
}

}  // namespace palpate::geometry
