// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "commands/describe_mesh.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::apps {

/// Checks that coordinates are such that functions on clouds accept them.
/// \throws InvalidInput naming the file and the point.
void check_coordinates(const std::filesystem::path& path, const geometry::PointCloud& cloud);

/// Describes points: how many, where, how far from each other, and what is known of each.
[[nodiscard]] Description describe_cloud(const geometry::PointCloud& cloud);

}  // namespace palpate::apps
