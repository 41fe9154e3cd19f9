// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "files/polygon_mesh.h"

namespace palpate::geometry {

/// Reads glTF (whose unit is the metre) and whatever else assimp knows, in float: the parts of a
/// scene are put together as it places them, with normals and colours if all parts have them.
/// \throws FileError if the file is missing, empty, of an unknown ending or damaged.
[[nodiscard]] PolygonMesh read_assimp_scene(const std::filesystem::path& path);

}  // namespace palpate::geometry
