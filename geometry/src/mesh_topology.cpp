// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_topology.h"

#include <string>

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

}  // namespace palpate::geometry
