// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/geometry/mesh_io.h"
#include "surfaces/describe_mesh.h"

namespace palpate::apps {

/// Checks that coordinates are such that functions on clouds accept them.
/// \throws InvalidInput naming the file and the point.
void check_coordinates(const fs::path& path, const geometry::PointCloud& cloud);

/// Describes points: how many, where, how far from each other, and what is known of each.
[[nodiscard]] Description describe_cloud(const geometry::PointCloud& cloud);

/// "X 0.0 to 10.0, Y -3.5 to 2.0, Z 500.0 to 510.0 mm": with enough decimals to give the diagonal
/// three digits, at least one.
[[nodiscard]] std::string in_words(const Eigen::AlignedBox3d& box);

}  // namespace palpate::apps
