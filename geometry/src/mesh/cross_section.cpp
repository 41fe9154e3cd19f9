// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cross_section.h"

#include <algorithm>
#include <map>
#include <utility>

#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

/// The mesh edge that the plane crosses: its two vertices, the smaller index first.
using Edge = std::pair<int, int>;

/// For each crossed edge, the crossed edges to which triangles join it.
std::map<Edge, std::vector<Edge>> crossings(const TriangleMesh& mesh,
                                            const Eigen::VectorXd& height) {
  std::map<Edge, std::vector<Edge>> neighbors;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    std::vector<Edge> crossed;
    for (int i = 0; i < 3; ++i) {
      const int a = mesh.triangles(i, t);
      const int b = mesh.triangles((i + 1) % 3, t);
      if ((height[a] < 0) != (height[b] < 0)) crossed.emplace_back(std::minmax(a, b));
    }
    if (crossed.size() == 2) {
      neighbors[crossed[0]].push_back(crossed[1]);
      neighbors[crossed[1]].push_back(crossed[0]);
    }
  }
  return neighbors;
}

Eigen::Vector3d crossing_point(const TriangleMesh& mesh, const Eigen::VectorXd& height,
                               const Edge& edge) {
  const Eigen::Vector3d a = mesh.vertices.col(edge.first);
  const Eigen::Vector3d b = mesh.vertices.col(edge.second);
  const double t = height[edge.first] / (height[edge.first] - height[edge.second]);
  return (1 - t) * a + t * b;
}

/// Follows a line from `start` and removes the edges it passes from `neighbors`.
std::vector<Edge> take_line(std::map<Edge, std::vector<Edge>>& neighbors, Edge start) {
  std::vector<Edge> line;
  for (Edge at = start;;) {
    line.push_back(at);
    const std::vector<Edge> next = std::move(neighbors.extract(at).mapped());
    const auto free = std::find_if(next.begin(), next.end(),
                                   [&](const Edge& e) { return neighbors.contains(e); });
    if (free == next.end()) {
      const bool closed =
          line.size() > 2 && std::find(next.begin(), next.end(), start) != next.end();
      if (closed) line.push_back(start);
      return line;
    }
    at = *free;
  }
}

Polyline to_polyline(const TriangleMesh& mesh, const Eigen::VectorXd& height, int axis,
                     const std::vector<Edge>& edges) {
  Polyline line(3, static_cast<Eigen::Index>(edges.size()));
  for (Eigen::Index i = 0; i < line.cols(); ++i) {
    line.col(i) = crossing_point(mesh, height, edges[static_cast<std::size_t>(i)]);
  }
  if (line(axis, 0) > line(axis, line.cols() - 1)) line.rowwise().reverseInPlace();
  return line;
}

}  // namespace

std::vector<Polyline> cross_section(const TriangleMesh& mesh, const Plane& plane) {
  check_mesh(mesh, "cross_section(): mesh");
  if (!plane.point.allFinite() || !plane.normal.allFinite() || plane.normal.isZero(0))
    throw InvalidInput(
        "cross_section(): plane: its point and normal must be finite, and the normal not zero");
  const Eigen::VectorXd height = (mesh.vertices.colwise() - plane.point).transpose() *
                                 plane.normal.stableNormalized();  // [mm] above the plane
  Eigen::Index along_normal = 0;
  plane.normal.cwiseAbs().maxCoeff(&along_normal);
  const int axis = along_normal == 0 ? 1 : 0;  // along which the lines are ordered
  std::map<Edge, std::vector<Edge>> neighbors = crossings(mesh, height);
  std::vector<Edge> ends;
  for (const auto& [edge, joined] : neighbors) {
    if (joined.size() == 1) ends.push_back(edge);
  }
  std::vector<Polyline> lines;
  for (const Edge& end : ends) {  // open lines first; the remaining ones are closed
    if (neighbors.contains(end))
      lines.push_back(to_polyline(mesh, height, axis, take_line(neighbors, end)));
  }
  while (!neighbors.empty())
    lines.push_back(
        to_polyline(mesh, height, axis, take_line(neighbors, neighbors.begin()->first)));
  std::sort(lines.begin(), lines.end(),
            [axis](const Polyline& a, const Polyline& b) { return a(axis, 0) < b(axis, 0); });
  return lines;
}

std::vector<Polyline> cross_section(const TriangleMesh& mesh, double y) {
  return cross_section(mesh, Plane{.point = {0, y, 0}, .normal = {0, 1, 0}});
}

}  // namespace palpate::geometry
