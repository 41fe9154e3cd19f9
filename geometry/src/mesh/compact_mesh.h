// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// A mesh without the vertices that no triangle uses. Its triangles have the same indices as
/// before.
struct CompactMesh {
  TriangleMesh mesh;
  std::vector<int> source;  ///< the former index of each vertex, ascending
};

[[nodiscard]] CompactMesh compact(const TriangleMesh& mesh);

}  // namespace palpate::geometry
