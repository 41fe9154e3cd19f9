// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// What a mesh file holds, before anything is checked.
struct PolygonMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::int64_t>
      corners;             ///< vertex indices of all polygons, one polygon after the other
  std::vector<int> sizes;  ///< corners of each polygon
};

/// The vertices, 3 x V.
[[nodiscard]] Eigen::Matrix3Xd vertex_matrix(const PolygonMesh& mesh);

/// Cuts polygons into triangles by clipping ears, so that one that is not convex keeps its outline.
/// A triangle that uses a vertex twice has no area and is left out.
/// \throws FileError naming `file`, the polygon and its corner if an index is out of range, if a
/// polygon has less than 3 corners, a vertex is not finite, or there is no triangle.
[[nodiscard]] TriangleMesh triangulate(const PolygonMesh& mesh, const std::string& file);

}  // namespace palpate::geometry
