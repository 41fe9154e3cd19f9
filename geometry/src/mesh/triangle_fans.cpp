// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "mesh/triangle_fans.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <queue>
#include <utility>

#include "base/numbers.h"

namespace palpate::geometry {
namespace {

/// Squared sine assigned to a corner of a triangle without area, so that the signs of its products
/// still indicate where its apex is: the square of the rounding of a double.
constexpr double kLeastSquaredSine = 1e-32;

/// A path bends at a vertex of the border iff the angle of the surface there exceeds pi by this
/// many radians, so that noise on a straight border does not count as a corner.
constexpr double kCornerAngle = 0.1;

/// Two neighbours of a vertex that are the other corners of a triangle, and the angle between them.
struct Link {
  int low, high;
  double angle;
};

/// Angles along the surface from one neighbour of a vertex to all; infinite if not connected.
std::vector<double> angles_from(int first, const std::vector<Link>& links, std::size_t count) {
  std::vector<std::vector<std::pair<int, double>>> beside(count);
  for (const Link& link : links) {
    beside[static_cast<std::size_t>(link.low)].emplace_back(link.high, link.angle);
    beside[static_cast<std::size_t>(link.high)].emplace_back(link.low, link.angle);
  }
  std::vector<double> angles(count, kInfinity);
  std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>>
      queue;
  const auto reach = [&](int neighbour, double angle) {
    if (!(angle < angles[static_cast<std::size_t>(neighbour)])) return;
    angles[static_cast<std::size_t>(neighbour)] = angle;
    queue.emplace(angle, neighbour);
  };
  reach(first, 0);
  while (!queue.empty()) {
    const auto [angle, neighbour] = queue.top();
    queue.pop();
    if (angle > angles[static_cast<std::size_t>(neighbour)]) continue;
    for (const auto& [other, between] : beside[static_cast<std::size_t>(neighbour)])
      reach(other, angle + between);
  }
  return angles;
}

/// The largest angle along the surface between two neighbours of a vertex; infinite if its
/// triangles form several fans. Exact where these angles form a tree, as at the end of an edge
/// that several sheets share; elsewhere it may be too small.
double widest_angle(const std::vector<Link>& links, std::size_t count) {
  const std::vector<double> from_any = angles_from(0, links, count);
  const auto farthest = std::max_element(from_any.begin(), from_any.end());
  if (*farthest == kInfinity) return kInfinity;
  const std::vector<double> angles =
      angles_from(static_cast<int>(farthest - from_any.begin()), links, count);
  return *std::max_element(angles.begin(), angles.end());
}

/// The triangles at a vertex as links between its neighbours; a triangle that is there twice counts
/// once.
std::vector<Link> links_around(const TriangleFans& fans, std::size_t vertex) {
  std::vector<Link> links;
  for (int i = fans.first_corner[vertex]; i < fans.first_corner[vertex + 1]; ++i) {
    const TriangleFans::Corner& corner = fans.corners[static_cast<std::size_t>(i)];
    const auto [low, high] = std::minmax(corner.next, corner.last);
    links.push_back(
        {.low = low, .high = high, .angle = std::atan2(std::sqrt(corner.cross), corner.dot)});
  }
  const auto place = [](const Link& link) { return std::pair(link.low, link.high); };
  std::sort(links.begin(), links.end(),
            [&](const Link& a, const Link& b) { return place(a) < place(b); });
  links.erase(std::unique(links.begin(), links.end(),
                          [&](const Link& a, const Link& b) { return place(a) == place(b); }),
              links.end());
  return links;
}

/// Paths bend where the surface turns round a corner of its border. Inside they do not, also where
/// several sheets share an edge: any two of them continue each other.
bool bends_at(const TriangleFans& fans, std::size_t vertex, std::vector<int>& triangles) {
  const auto count =
      static_cast<std::size_t>(fans.first_neighbour[vertex + 1] - fans.first_neighbour[vertex]);
  triangles.assign(count, 0);  // of each neighbour
  for (int i = fans.first_corner[vertex]; i < fans.first_corner[vertex + 1]; ++i) {
    const TriangleFans::Corner& corner = fans.corners[static_cast<std::size_t>(i)];
    ++triangles[static_cast<std::size_t>(corner.next)];
    ++triangles[static_cast<std::size_t>(corner.last)];
  }
  if (std::all_of(triangles.begin(), triangles.end(), [](int number) { return number == 2; }))
    return false;
  const std::vector<Link> links = links_around(fans, vertex);
  triangles.assign(count, 0);
  for (const Link& link : links) {
    ++triangles[static_cast<std::size_t>(link.low)];
    ++triangles[static_cast<std::size_t>(link.high)];
  }
  if (std::find(triangles.begin(), triangles.end(), 1) == triangles.end()) return false;
  return widest_angle(links, count) > std::numbers::pi + kCornerAngle;
}

void find_turns(TriangleFans& fans) {
  fans.turns.assign(fans.longest.size(), 0);
  std::vector<int> scratch;
  for (std::size_t v = 0; v < fans.turns.size(); ++v)
    fans.turns[v] = bends_at(fans, v, scratch) ? 1 : 0;
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
