// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>

#include "files/polygon_mesh.h"

namespace palpate::geometry {

/// Reads STL, binary or text; corners at exactly the same place become one vertex. Normals and the
/// attribute bytes of triangles are skipped. Assimp is not used as it rounds what a text says.
/// \throws FileError naming the triangle or the line that is wrong, or if the file is truncated.
[[nodiscard]] PolygonMesh read_stl(const std::filesystem::path& path);

/// Writes binary (float) or text (as many digits as it takes), with the triangles' normals (zero
/// where there is no area). Pre: coordinates are in the range of float if binary.
void write_stl(std::ostream& stream, const TriangleMesh& mesh, Encoding encoding);

}  // namespace palpate::geometry
