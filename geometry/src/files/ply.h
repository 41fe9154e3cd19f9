// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>

#include "files/polygon_mesh.h"

namespace palpate::geometry {

/// Reads PLY: text or binary of either byte order, coordinates and indices of any type. All
/// properties of vertices and faces are kept; elements other than vertex, face and tristrips are
/// skipped. Beside tristrips, attributes of faces are skipped too. Assimp is not used as it keeps
/// coordinates in float only.
/// \throws FileError if the file is missing, truncated (saying how much of it is there) or wrong.
[[nodiscard]] PolygonMesh read_ply(const std::filesystem::path& path);

/// Writes coordinates and the attributes in their types; no faces if there are no triangles.
/// \throws InvalidInput naming `what` if an attribute has a name of PLY's own, or a type that PLY
/// does not know.
void write_ply(std::ostream& stream, const MeshFile& file, const WriteOptions& options,
               const char* what);

}  // namespace palpate::geometry
