// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_topology.h"

#include <algorithm>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "base/numbers.h"
#include "mesh/edge_table.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

[[noreturn]] void refuse(const Eigen::Matrix3Xi& triangles, int half_edge, int other) {
  const int from = triangles(half_edge % 3, half_edge / 3);
  const int to = triangles((half_edge + 1) % 3, half_edge / 3);
  throw InvalidInput("mesh: triangles " + std::to_string(other / 3) + " and " +
                     std::to_string(half_edge / 3) + " both run along the edge from vertex " +
                     std::to_string(from) + " to vertex " + std::to_string(to) +
                     ": one of them is turned over, or more than two meet there");
}

}  // namespace

Eigen::Matrix3Xi opposite_half_edges(const TriangleMesh& mesh) {
  check_mesh(mesh, "mesh");
  Eigen::Matrix3Xi opposite = Eigen::Matrix3Xi::Constant(3, mesh.triangles.cols(), kNone);
  // The first half-edge with the same direction as an earlier one, and that earlier one.
  std::pair<int, int> repeated = {std::numeric_limits<int>::max(), kNone};
  for_each_edge(sort_sides(mesh.triangles), [&](std::span<const EdgeSide> sides) {
    if (sides.size() == 1) return;
    if (sides.size() == 2 && sides[0].upwards != sides[1].upwards) {
      const auto [a, b] = std::pair(sides[0].half_edge, sides[1].half_edge);
      opposite(a % 3, a / 3) = b;
      opposite(b % 3, b / 3) = a;
      return;
    }
    for (const bool upwards : {false, true}) {
      std::pair<int, int> found = {kNone, kNone};  // the first two of this direction
      for (const EdgeSide& side : sides) {
        if (side.upwards != upwards || found.second != kNone) continue;
        (found.first == kNone ? found.first : found.second) = side.half_edge;
      }
      if (found.second != kNone) repeated = std::min(repeated, {found.second, found.first});
    }
  });
  if (repeated.second != kNone) refuse(mesh.triangles, repeated.first, repeated.second);
  return opposite;
}

std::vector<std::vector<int>> boundary_loops(const TriangleMesh& mesh) {
  const Eigen::Matrix3Xi opposite = opposite_half_edges(mesh);
  const auto next = [](int h) { return h % 3 == 2 ? h - 2 : h + 1; };
  std::vector<bool> done(static_cast<std::size_t>(opposite.size()), false);
  std::vector<std::vector<int>> loops;
  for (int start = 0; start < opposite.size(); ++start) {
    if (opposite(start % 3, start / 3) != kNone || done[static_cast<std::size_t>(start)]) continue;
    std::vector<int> loop;
    for (int h = start; !done[static_cast<std::size_t>(h)];) {
      done[static_cast<std::size_t>(h)] = true;
      loop.push_back(mesh.triangles(h % 3, h / 3));
      // Turn around the vertex at the end of h, through connected triangles.
      h = next(h);
      while (opposite(h % 3, h / 3) != kNone) h = next(opposite(h % 3, h / 3));
    }
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
    loops.push_back(std::move(loop));
  }
  std::sort(loops.begin(), loops.end());
  return loops;
}

ConnectedComponents connected_components(const TriangleMesh& mesh) {
  const Eigen::Matrix3Xi opposite = opposite_half_edges(mesh);
  ConnectedComponents result{Eigen::VectorXi::Constant(opposite.cols(), kNone), 0};
  std::vector<int> open;
  for (int first = 0; first < opposite.cols(); ++first) {
    if (result.component[first] != kNone) continue;
    result.component[first] = result.count;
    open.push_back(first);
    while (!open.empty()) {
      const int triangle = open.back();
      open.pop_back();
      for (const int other : opposite.col(triangle)) {
        if (other == kNone || result.component[other / 3] != kNone) continue;
        result.component[other / 3] = result.count;
        open.push_back(other / 3);
      }
    }
    ++result.count;
  }
  return result;
}

int euler_characteristic(const TriangleMesh& mesh) {
  const Eigen::Matrix3Xi opposite = opposite_half_edges(mesh);
  std::vector<bool> used(static_cast<std::size_t>(mesh.vertices.cols()), false);
  for (const int vertex : mesh.triangles.reshaped()) used[static_cast<std::size_t>(vertex)] = true;
  const auto vertices = std::count(used.begin(), used.end(), true);
  const Eigen::Index border = (opposite.array() == kNone).count();
  const Eigen::Index edges = border + (opposite.size() - border) / 2;
  return static_cast<int>(vertices - edges + mesh.triangles.cols());
}

}  // namespace palpate::geometry
