// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <variant>

#include "palpate/geometry/mesh_io.h"

namespace palpate::geometry {

/// Reads a file once and returns its content: points if it is a PCD file or has only vertices,
/// otherwise a mesh.
/// \throws FileError, InvalidInput as `read_mesh_file` and `read_point_cloud`.
[[nodiscard]] std::variant<MeshFile, PointCloud> read_mesh_or_points(
    const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace palpate::geometry
