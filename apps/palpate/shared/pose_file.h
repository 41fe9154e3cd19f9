// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include "shared/aliases.h"

namespace palpate::apps {

/// Reads a rigid motion: a text file with the 3 x 4 or 4 x 4 numbers of its matrix, row by row,
/// separated by spaces, commas or line ends; translation in mm.
/// \throws FileError naming what is wrong: the file is missing, has another count of numbers or one
/// that is not finite, has a last row other than 0 0 0 1, or the matrix is not a rotation
/// (orthogonal to 1e-6, right-handed).
[[nodiscard]] Eigen::Isometry3d read_pose(const fs::path& path);

}  // namespace palpate::apps
