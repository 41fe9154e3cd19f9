// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>

#include "polygon_mesh.h"

namespace palpate::geometry {

/// Reads PLY: text or binary of either byte order, coordinates and indices of any type. Elements
/// and properties other than `vertex` x y z and `face` vertex_indices (or vertex_index) are
/// skipped. Assimp is not used as it keeps coordinates in float only.
/// \throws FileError if the file is missing, truncated (saying how much of it is there) or wrong.
[[nodiscard]] PolygonMesh read_ply(const std::filesystem::path& path);

/// Writes binary PLY, least significant byte first, float64 coordinates.
void write_ply(std::ostream& stream, const TriangleMesh& mesh);

}  // namespace palpate::geometry
