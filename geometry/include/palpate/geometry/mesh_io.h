// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Reads a surface; the ending of `path` says which format it is. Coordinates are taken as mm.
/// Polygons are cut into triangles; a triangle that uses a vertex twice is left out.
///
/// PLY and OBJ are read to the last digit. STL, OFF, glTF and whatever else assimp knows have the
/// precision of float; the parts of a scene are put together as it places them; and where no two
/// triangles share a vertex (STL), corners at exactly the same place become one. Otherwise vertices
/// and their order are those of the file. Some damage, such as a bad index in OFF, assimp mends
/// without a word.
/// \throws FileError if the file is missing, truncated, empty, not a mesh, or holds a bad index or
/// a vertex that is not finite.
[[nodiscard]] TriangleMesh read_mesh(const std::filesystem::path& path);

/// Reads points, 3 x N [mm]: PCD (text, binary or compressed) or the vertices of any mesh file. PLY
/// and OBJ need no faces. In an organised PCD unknown points are NaN and are kept, and so are those
/// of PLY. \throws FileError as `read_mesh`, or if there is no point.
[[nodiscard]] Eigen::Matrix3Xd read_points(const std::filesystem::path& path);

/// Writes by the ending of `path`: .ply (binary, float64 vertices) or .obj (text); `read_mesh`
/// gives back the same numbers. \throws InvalidInput for another ending or a bad mesh; OutputError.
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace palpate::geometry
