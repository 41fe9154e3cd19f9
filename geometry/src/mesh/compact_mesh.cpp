// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "mesh/compact_mesh.h"

#include <cstddef>

namespace palpate::geometry {

CompactMesh compact(const TriangleMesh& mesh, std::span<const int> also) {
  std::vector<int> index(static_cast<std::size_t>(mesh.vertices.cols()), -1);
  for (const int v : mesh.triangles.reshaped()) index[static_cast<std::size_t>(v)] = 0;
  for (const int v : also) index[static_cast<std::size_t>(v)] = 0;
  CompactMesh result;
  for (std::size_t v = 0; v < index.size(); ++v) {
    if (index[v] < 0) continue;
    index[v] = static_cast<int>(result.source.size());
    result.source.push_back(static_cast<int>(v));
  }
  result.mesh.vertices = mesh.vertices(Eigen::all, result.source);
  result.mesh.triangles =
      mesh.triangles.unaryExpr([&index](int v) { return index[static_cast<std::size_t>(v)]; });
  return result;
}

}  // namespace palpate::geometry
