// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "files/polygon_mesh.h"

namespace palpate::geometry {

/// Reads text OFF with its comments. Colours and normals are read if the first word announces them
/// (COFF, NOFF, CNOFF, with or without ST) and every vertex has them; data after a face is skipped.
/// Assimp is not used because it silently replaces an invalid index by a valid one.
/// \throws FileError naming the line if a vertex or a face is wrong, or if the file is truncated.
[[nodiscard]] PolygonMesh read_off(const std::filesystem::path& path);

}  // namespace palpate::geometry
