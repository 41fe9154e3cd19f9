// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <filesystem>

namespace palpate::apps {

/// Reads a rigid motion: a text file of the 3 x 4 or 4 x 4 numbers of its matrix, row by row,
/// between spaces, commas or line ends; shift in mm.
/// \throws FileError naming what is wrong: missing, not so many numbers, one that is not finite, a
/// last row other than 0 0 0 1, or no rotation (orthogonal to 1e-6, right-handed).
[[nodiscard]] Eigen::Isometry3d read_pose(const std::filesystem::path& path);

}  // namespace palpate::apps
