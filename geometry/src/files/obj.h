// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>

#include "files/polygon_mesh.h"

namespace palpate::geometry {

/// Reads the vertices and faces of a Wavefront OBJ file, its comments, and colours and normals if
/// every vertex has exactly one. Other content (textures, groups, materials) is skipped. Assimp is
/// not used because it stores coordinates in float and gives every corner of every face its own
/// vertex.
/// \throws FileError naming the line if a vertex or a face is wrong.
[[nodiscard]] PolygonMesh read_obj(const std::filesystem::path& path);

/// Writes text with enough digits to read back the same numbers: vertices with their colours,
/// normals, triangles.
void write_obj(std::ostream& stream, const MeshFile& file);

}  // namespace palpate::geometry
