// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "files/polygon_mesh.h"

namespace palpate::geometry {

/// Reads glTF (in metres) and all other formats of assimp, in float. The parts of a scene are
/// combined at their positions, with normals and colours if all parts have them.
/// \throws FileError if the file is missing, empty, damaged, or has an unknown extension.
[[nodiscard]] PolygonMesh read_assimp_scene(const std::filesystem::path& path);

}  // namespace palpate::geometry
