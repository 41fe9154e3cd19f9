// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "palpate/geometry/mesh_io.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// Description of a file in numbers and in words.
struct Description {
  Json figures;
  std::string prose;
};

/// Describes a mesh file: size, unit and attributes, defects, and measures of its surface; or a
/// file of points.
/// \throws FileError if it can be read as neither, not even as a defective mesh.
[[nodiscard]] Description describe_mesh(const fs::path& path, geometry::ReadOptions options);

/// Checks that functions on clouds accept the coordinates.
/// \throws InvalidInput naming the file and the point.
void check_coordinates(const fs::path& path, const geometry::PointCloud& cloud);

/// Describes points: their number, bounding box, distances from each other, and attributes.
[[nodiscard]] Description describe_cloud(const geometry::PointCloud& cloud);

}  // namespace palpate::apps
