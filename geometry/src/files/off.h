// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "files/polygon_mesh.h"

namespace palpate::geometry {

/// Reads text OFF with the comments and, if its first word announces them (COFF, NOFF, CNOFF, with
/// or without ST) and every vertex has them, colours and normals; what stands behind a face is
/// skipped.
/// Assimp is not used as it replaces a bad index by a good one without a word.
/// \throws FileError naming the line if a vertex or a face is wrong, or if the file is truncated.
[[nodiscard]] PolygonMesh read_off(const std::filesystem::path& path);

}  // namespace palpate::geometry
