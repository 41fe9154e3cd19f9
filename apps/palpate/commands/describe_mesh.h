// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "palpate/geometry/mesh_io.h"

namespace palpate::apps {

/// What a file is, in numbers and in words.
struct Description {
  nlohmann::ordered_json figures;
  std::string prose;
};

/// A mesh file: its size, unit and attributes, its defects, and what its surface measures.
/// \throws FileError if it cannot be read as a mesh, broken or not.
[[nodiscard]] Description describe_mesh(const std::filesystem::path& path,
                                        geometry::ReadOptions options);

/// A file of points.
/// \throws FileError if it cannot be read.
[[nodiscard]] Description describe_points(const std::filesystem::path& path,
                                          const geometry::ReadOptions& options);

}  // namespace palpate::apps
