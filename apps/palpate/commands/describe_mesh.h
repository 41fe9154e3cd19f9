// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "palpate/geometry/mesh_io.h"

namespace palpate::apps {

/// Description of a file in numbers and in words.
struct Description {
  nlohmann::ordered_json figures;
  std::string prose;
};

/// Describes a mesh file: size, unit and attributes, defects, and measures of its surface.
/// \throws FileError if it cannot be read as a mesh, even a defective one.
[[nodiscard]] Description describe_mesh(const std::filesystem::path& path,
                                        geometry::ReadOptions options);

/// Describes a file of points.
/// \throws FileError if it cannot be read.
[[nodiscard]] Description describe_points(const std::filesystem::path& path,
                                          const geometry::ReadOptions& options);

}  // namespace palpate::apps
