// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_topology.h"

#include <algorithm>
#include <string>
#include <utility>

#include "palpate/error.h"

namespace palpate::geometry {
namespace {

constexpr int kNone = -1;

[[noreturn]] void refuse(int from, int to, int half_edge, int other) {
  throw InvalidInput("mesh: triangles " + std::to_string(other / 3) + " and " +
                     std::to_string(half_edge / 3) + " both run along the edge from vertex " +
                     std::to_string(from) + " to vertex " + std::to_string(to) +
                     ": one of them is turned over, or more than two meet there");
}

}  // namespace

Eigen::Matrix3Xi opposite_half_edges(const TriangleMesh& mesh) {
  check_mesh(mesh, "mesh");
  const auto count = static_cast<int>(mesh.triangles.size());
  const auto from = [&](int half_edge) { return mesh.triangles(half_edge % 3, half_edge / 3); };
  const auto to = [&](int half_edge) { return mesh.triangles((half_edge + 1) % 3, half_edge / 3); };
  // The half-edges that leave a vertex, as linked lists.
  Eigen::VectorXi first = Eigen::VectorXi::Constant(mesh.vertices.cols(), kNone);
  Eigen::VectorXi next(count);
  for (int h = 0; h < count; ++h) {
    for (int other = first[from(h)]; other != kNone; other = next[other]) {
      if (to(other) == to(h)) refuse(from(h), to(h), h, other);
    }
    next[h] = first[from(h)];
    first[from(h)] = h;
  }
  Eigen::Matrix3Xi opposite(3, mesh.triangles.cols());
  for (int h = 0; h < count; ++h) {
    int other = first[to(h)];
    while (other != kNone && to(other) != from(h)) other = next[other];
    opposite(h % 3, h / 3) = other;
  }
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
      // Around the vertex at the end of h, through the triangles that hang together there.
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
