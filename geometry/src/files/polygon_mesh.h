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

/// What a mesh file holds, before anything is checked.
struct PolygonMesh {
  std::vector<Eigen::Vector3d> vertices;  ///< in the unit of the file
  std::vector<std::int64_t>
      corners;             ///< vertex indices of all polygons, one polygon after the other
  std::vector<int> sizes;  ///< corners of each polygon
  Attributes vertex_attributes;
  Attributes face_attributes;
  std::vector<std::string> comments;  ///< also such as declare a unit
  std::optional<double> unit;         ///< [mm] if the format itself declares one
};

/// The vertices, 3 x V.
[[nodiscard]] Eigen::Matrix3Xd vertex_matrix(const PolygonMesh& mesh);

/// Cuts polygons into triangles by clipping ears, so that one that is not convex keeps its outline;
/// its attributes go along to each of its triangles. A triangle that uses a vertex twice has no
/// area and is left out. Unit and comments are left to the caller.
/// \throws FileError naming `file`, the polygon and its corner if an index is out of range, if a
/// polygon has less than 3 corners, a vertex is not finite, or there is no triangle; of these only
/// the last with `keep_defects` (see ReadOptions).
[[nodiscard]] MeshFile triangulate(PolygonMesh mesh, const std::string& file,
                                   bool keep_defects = false);

/// A format that lists the corners of every face anew loses which faces are neighbours. Exactly
/// equal places tell it again; near ones are left alone, as only the user can say what near is.
/// Does nothing if vertices are shared already, or one is not finite. Where corners become one,
/// vertex attributes are dropped.
void join_corners(PolygonMesh& mesh);

}  // namespace palpate::geometry
