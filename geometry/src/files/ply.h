// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>

#include "files/polygon_mesh.h"

namespace palpate::geometry {

/// Reads PLY: text or binary in either byte order, with coordinates and indices of any type. All
/// properties of vertices and faces are kept; elements other than vertex, face and tristrips are
/// skipped, and so are face attributes if there are tristrips. Assimp is not used because it stores
/// coordinates in float.
/// \throws FileError if the file is missing, not valid, or truncated (saying how much is there).
[[nodiscard]] PolygonMesh read_ply(const std::filesystem::path& path);

/// Writes coordinates and attributes in their types; no faces if there are no triangles.
/// \throws InvalidInput naming `what` if an attribute has a name that PLY reserves, or a type that
/// PLY does not have.
void write_ply(std::ostream& stream, const MeshFile& file, const WriteOptions& options,
               const char* what);

}  // namespace palpate::geometry
