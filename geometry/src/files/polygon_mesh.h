// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "palpate/geometry/mesh_io.h"

namespace palpate::geometry {

/// Unchecked content of a mesh file.
struct PolygonMesh {
  std::vector<Eigen::Vector3d> vertices;  ///< in the unit of the file
  std::vector<std::int64_t> corners;      ///< vertex indices of all polygons, grouped by polygon
  std::vector<int> sizes;                 ///< number of corners of each polygon
  Attributes vertex_attributes;
  Attributes face_attributes;
  std::vector<std::string> comments;                   ///< including those that declare a unit
  std::optional<double> unit;                          ///< [mm] if the format itself declares one
  std::vector<std::string> material_files, materials;  ///< see MeshFile
};

/// The vertices, 3 x V.
[[nodiscard]] Eigen::Matrix3Xd vertex_matrix(const PolygonMesh& mesh);

/// Triangulates polygons by ear clipping, so that concave polygons keep their outline. Attributes
/// of a polygon go to each of its triangles; of `texcoord`, a list of two numbers for each corner,
/// those of the triangle's corners. A triangle that uses a vertex twice has no area and is
/// left out. The caller handles unit and comments.
/// \throws FileError naming `file`, the polygon and its corner if an index is out of range, a
/// polygon has fewer than 3 corners, a vertex is not finite, or there is no triangle. With
/// `keep_defects` (see ReadOptions) only the last is an error.
[[nodiscard]] MeshFile triangulate(PolygonMesh mesh, const std::string& file,
                                   bool keep_defects = false);

/// Joins corners at exactly equal positions, for formats that repeat the corners of every face and
/// so lose its neighbours. Close but different positions are not joined, because only the user
/// knows what counts as close. Does nothing if vertices are already shared or one is not finite.
/// Vertex attributes are dropped if corners are joined.
void join_corners(PolygonMesh& mesh);

}  // namespace palpate::geometry
