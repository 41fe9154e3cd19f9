// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>

#include "files/polygon_mesh.h"

namespace palpate::geometry {

/// Reads binary or text STL; corners at exactly the same place become one vertex. Normals and
/// attribute bytes are skipped. Assimp is not used because it rounds the numbers of text files.
/// \throws FileError naming the triangle or line that is not valid, or if the file is truncated.
[[nodiscard]] PolygonMesh read_stl(const std::filesystem::path& path);

/// Writes binary (float) or text (enough digits to read back the same numbers), with the normals of
/// the triangles (zero for zero area). Precondition: binary coordinates are in the range of float.
void write_stl(std::ostream& stream, const TriangleMesh& mesh, Encoding encoding);

}  // namespace palpate::geometry
