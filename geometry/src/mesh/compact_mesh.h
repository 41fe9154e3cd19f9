// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// A mesh without vertices that no triangle uses. Its triangles have the same indices as
/// before.
struct CompactMesh {
  TriangleMesh mesh;
  std::vector<int> source;  ///< the former index of each vertex, ascending
};

/// Keeps the vertices `also` even if no triangle uses them.
[[nodiscard]] CompactMesh compact(const TriangleMesh& mesh, std::span<const int> also = {});

}  // namespace palpate::geometry
