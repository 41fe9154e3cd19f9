// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Reads a surface (PLY, OBJ, STL, OFF, glTF and whatever else assimp knows). Vertices at the same
/// place are kept apart as in the file, except in formats without shared vertices (STL).
/// \throws FileError if the file is missing, truncated, empty, not a mesh, or holds a bad index.
[[nodiscard]] TriangleMesh read_mesh(const std::filesystem::path& path);

/// Reads points, 3 x N [mm]: PCD (text, binary or compressed) or the vertices of any mesh file. In an
/// organised PCD unknown points are NaN and are kept.
/// \throws FileError as `read_mesh`.
[[nodiscard]] Eigen::Matrix3Xd read_points(const std::filesystem::path& path);

/// Writes by the ending of `path`: .ply (binary, float64 vertices) or .obj (text, round-trip exact).
/// \throws InvalidInput for another ending or a bad mesh; OutputError.
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace palpate::geometry
