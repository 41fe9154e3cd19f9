// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>

#include "files/polygon_mesh.h"

namespace palpate::geometry {

/// Reads the vertices and faces of a Wavefront OBJ, its comments, and colours and normals where
/// every vertex has exactly one; what else it holds (textures, groups, materials) is skipped.
/// Assimp is not used as it keeps coordinates in float only and gives every corner of every face a
/// vertex of its own.
/// \throws FileError naming the line if a vertex or a face is wrong.
[[nodiscard]] PolygonMesh read_obj(const std::filesystem::path& path);

/// Writes text with as many digits as it takes to read back the same numbers: vertices with their
/// colours, normals, triangles.
void write_obj(std::ostream& stream, const MeshFile& file);

}  // namespace palpate::geometry
