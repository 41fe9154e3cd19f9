// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace palpate::geometry {

/// Whether a file holds points without any face, for `read_point_cloud` rather than `read_mesh`: a
/// PCD file (which is not read), or a PLY, OBJ or OFF file with vertices alone.
/// \throws FileError if such a file is missing, truncated or damaged.
[[nodiscard]] bool holds_points_alone(const std::filesystem::path& path);

}  // namespace palpate::geometry
